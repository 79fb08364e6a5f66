// SPDX-License-Identifier: Apache-2.0
// The ledger as one web page: what to do now, then what to plan, then all plates.
#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "decoder/cli/report_ledger.hpp"
#include "tagsmith/base/date.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/web_page.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kLedgerStyle = R"css(
.do { font-size: 1rem; } .do th, .do td { font-size: 1rem; }
.do b { font-size: 1.05rem; } td b { white-space: nowrap; }
.none { color: var(--ok); } .reprint, .rehang { color: var(--faulty); }
.clean, .look, .plan { color: var(--poor); }
code { background: var(--card); border: 1px solid var(--line); border-radius: 6px; padding: 4px 8px;
  display: inline-block; overflow-wrap: anywhere; }
.spark { width: 132px; height: 30px; display: block; }
.spark .limit { stroke: var(--grey); stroke-dasharray: 3 3; }
.spark .line { fill: none; stroke: currentColor; stroke-width: 1.5; }
.spark circle { fill: currentColor; }
)css";

// What the word means for who does it.
const char* heading_of(PlateAction action) {
  constexpr std::array kHeadings{"Print anew and replace",
                                 "Clean",
                                 "Hang where it belongs",
                                 "Look what became of it",
                                 "Plan",
                                 "In order",
                                 "Not seen"};
  return kHeadings[static_cast<std::size_t>(action)];
}

std::string action_rows(const LedgerReport& report, PlateAction action) {
  std::string rows;
  for (const PlateState& plate : report.plates) {
    if (plate.action != action) continue;
    rows += fmt::format("<tr><td class=\"{}\"><b>{}</b></td><td>{}</td><td>{}</td></tr>\n",
                        to_string(action), markup_text(plate.tag), heading_of(action),
                        markup_text(plate.reason));
  }
  return rows;
}

std::string now_text(const Survey& survey, const LedgerReport& report) {
  std::string rows;
  for (const PlateAction action :
       {PlateAction::reprint, PlateAction::clean, PlateAction::rehang, PlateAction::look}) {
    rows += action_rows(report, action);
  }
  if (rows.empty()) return "<p class=\"none\">Nothing.</p>\n";
  std::string text =
      "<div class=\"scroll\"><table class=\"do\"><tbody>\n" + rows + "</tbody></table></div>\n";
  const std::string print = print_command_for(survey, report);
  if (!print.empty()) text += "<p><code>" + markup_text(print) + "</code></p>\n";
  return text;
}

std::string plan_text(const LedgerReport& report) {
  std::string rows;
  for (const PlateState& plate : report.plates) {
    if (plate.action != PlateAction::plan) continue;
    const PlateDue& due = *plate.due;
    rows += fmt::format(
        "<tr><td class=\"plan\"><b>{}</b></td><td>{} by "
        "<b>{}</b></td><td>{}</td><td>{}</td></tr>\n",
        markup_text(plate.tag), heading_of(*plate.cure), to_text(due.not_before),
        markup_text(due_in_words(plate)), markup_text(plate.reason));
  }
  if (rows.empty()) return "<p>Nothing: no plate's trend falls to a limit.</p>\n";
  return "<div class=\"scroll\"><table><thead><tr><th>tag</th><th>what</th><th>at the limit "
         "on</th><th>now</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
}

std::string mended_text(const LedgerReport& report) {
  if (report.mended.empty()) return "<p>Nothing yet.</p>\n";
  std::string rows;
  for (const MendedFault& fault : report.mended) {
    rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        markup_text(fault.tag), to_text(fault.in_order),
                        markup_text(fault.rule.empty() ? "low grade" : fault.rule),
                        last_found_in_words(fault));
  }
  return "<div class=\"scroll\"><table><thead><tr><th>tag</th><th>in order on</th><th>what it "
         "was</th><th>last found</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
}

// The days of all pictures, so that they can be compared.
struct Span {
  Day first;
  Day last;
};

Span span_of(const LedgerReport& report) {
  Span span{report.newest.value_or(Day{}), report.newest.value_or(Day{})};
  for (const PlateState& plate : report.plates) {
    if (!plate.series.empty()) span.first = std::min(span.first, plate.series.front().day);
  }
  return span;
}

// The grades of the days since the plate was mended, 4 at the top and 0 at the bottom; the broken
// line is 1, below which a plate fails.
std::string spark_of(const PlateState& plate, const Span& span) {
  if (plate.series.empty()) return "";
  constexpr double kWidth = 124, kHeight = 22, kMargin = 4;
  const double days = std::max(1.0, static_cast<double>((span.last - span.first).count()));
  const auto y_of = [&](double grade) { return kMargin + kHeight * (1 - grade / 4); };
  std::string points, circles;
  for (const PlateQuality& day : plate.series) {
    const auto since = static_cast<double>((day.day - span.first).count());
    const double x = kMargin + kWidth * since / days;
    const double y = y_of(std::clamp(day.grade, 0.0, 4.0));
    points += fmt::format("{}{:.1f} {:.1f}", points.empty() ? "M" : "L", x, y);
    circles += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\"/>", x, y);
  }
  return fmt::format(
      "<svg class=\"spark {}\" viewBox=\"0 0 132 30\" role=\"img\" aria-label=\"Grades of {} days, "
      "the last {:.1f}\"><path class=\"limit\" d=\"M{} {:.1f}h{}\"/><path class=\"line\" "
      "d=\"{}\"/>{}</svg>",
      to_string(plate.action), plate.series.size(), plate.series.back().grade, kMargin, y_of(1),
      kWidth, points, circles);
}

std::string plate_rows(const LedgerReport& report) {
  const Span span = span_of(report);
  std::string rows;
  for (const PlateState& plate : report.plates) {
    if (plate.action == PlateAction::unseen) continue;
    const std::string grade =
        plate.series.empty() ? "-" : fmt::format("{:.1f}", plate.series.back().grade);
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"{}\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
        "<td class=\"more\">{}</td></tr>\n",
        markup_text(plate.tag), to_string(plate.action), to_string(plate.action), grade,
        spark_of(plate, span), due_in_words(plate),
        plate.last_seen ? to_text(*plate.last_seen) : "-", plate.photos);
  }
  return rows;
}

std::string unseen_text(const Survey& survey, const LedgerReport& report) {
  const std::vector<std::string> tags = plates_to(PlateAction::unseen, survey, report);
  if (tags.empty()) return "<p>None.</p>\n";
  return "<p>" + markup_text(fmt::format("{}", fmt::join(tags, " "))) + "</p>\n";
}

std::string heading(const Survey& survey, const LedgerReport& report) {
  std::string text =
      "<h1>Ledger of " + markup_text(survey.name) + "</h1>\n" +
      fmt::format("<p class=\"sub\">{} photos{}; survey revision {}</p>\n", report.photos.photos,
                  days_in_words(report), survey_revision(survey));
  for (const std::string& sentence : doubts_in_words(report)) {
    text += "<p class=\"known\">" + markup_text(sentence) + ".</p>\n";
  }
  if (report.blames_camera()) {
    text += "<p class=\"poor\"><b>" + markup_text(camera_in_words(report)) + ".</b></p>\n";
  }
  return text;
}

constexpr const char* kLegend =
    "<details><summary>How to read this</summary><ul>\n"
    "<li>Grades are those of ISO/IEC 15416, 4 is best. Of each day the best photo counts. Below 1, "
    "the broken line, a plate fails; tagsmith reads many plates beyond that, other readers "
    "do not.</li>\n"
    "<li>A day in brackets is an interval that holds the true day four times out of five, if the "
    "plate goes on as it did. Beyond twice the days observed nothing is said but \"not "
    "before\".</li>\n"
    "<li>Clean: light is lost, and the edges of the bars are where they belong. Print anew: the "
    "edges moved, or elements are torn; cleaning does not bring them back.</li>\n"
    "<li>Look: photos show the plates on both sides, and not this one, on two days or "
    "more; or it failed on the last day alone.</li>\n</ul></details>\n";

}  // namespace

std::string ledger_page(const Survey& survey, const LedgerReport& report) {
  return page_head("Ledger of " + markup_text(survey.name),
                   std::string(report_style()) + kLedgerStyle, false) +
         heading(survey, report) + "<h2>To do now</h2>\n" + now_text(survey, report) +
         "<h2>To plan</h2>\n" + plan_text(report) + "<h2>Mended</h2>\n" + mended_text(report) +
         "<h2>In no photo with a date</h2>\n" + unseen_text(survey, report) +
         "<h2>All plates, the most urgent first</h2>\n<div class=\"scroll\"><table><thead><tr>"
         "<th>tag</th><th>what</th><th>grade</th><th>its days</th><th>at the limit on</th>"
         "<th>last seen</th><th class=\"more\">photos</th></tr></thead><tbody>\n" +
         plate_rows(report) + "</tbody></table></div>\n" + kLegend + "</body>\n</html>\n";
}

}  // namespace tagsmith::detail
