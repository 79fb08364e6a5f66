// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/report_ledger.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "decoder/cli/report_files.hpp"
#include "decoder/ledger/plate_history.hpp"
#include "tagsmith/base/date.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/web_page.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {

// ---- In words.

namespace {

// ", taken from 2026-03-12 to 2027-05-01"; empty when no photo says its day.
std::string days_in_words(const LedgerReport& report) {
  if (!report.newest) return "";
  return fmt::format(", taken from {} to {}", to_text(*report.oldest), to_text(*report.newest));
}

// A sentence for each kind of photos that say less than others, without its full stop.
std::vector<std::string> doubts_in_words(const LedgerReport& report) {
  const auto& photos = report.photos;
  const std::vector<std::pair<std::size_t, std::string>> doubts{
      {photos.undated, "of them without a date, and in no trend"},
      {photos.future,
       "of them dated in the future, and counted as undated: set the camera's clock"},
      {photos.clock_reset,
       fmt::format("of them dated before {}, and counted as undated: set the camera's clock",
                   kFirstPhotos.substr(0, 4))},
      {photos.other_revisions,
       "of them verified against another state of the survey: where plates hang was judged by "
       "that; verify them again"},
      {photos.mixed_revisions,
       "of these taken after photos of the present state: is there another survey of this name? "
       "Plates are confused unless each survey has its own name, or its own ledger"},
      {report.nameless,
       std::string(report.nameless == 1 ? "fault" : "faults") +
           " of plates that were not read when plates had other names: verify these photos again"}};
  std::vector<std::string> sentences;
  for (const auto& [count, words] : doubts) {
    if (count > 0) sentences.push_back(fmt::format("{} {}", count, words));
  }
  return sentences;
}

// "2026-03-12", or the words in its place.
std::string last_found_in_words(const MendedFault& fault) {
  return fault.last_found ? to_text(*fault.last_found) : "a photo without a date";
}

// "2027-05-01 (2027-03-12 to 2027-08-20)", "not before 2027-03-12", or "no trend yet".
std::string due_in_words(const PlateState& plate) {
  if (!plate.due) return "no trend yet";
  const PlateDue& due = *plate.due;
  if (due.is_past) return "passed";
  if (!due.expected) return "not before " + to_text(due.not_before);
  return fmt::format("{} ({} {})", to_text(*due.expected), to_text(due.not_before),
                     due.not_after ? "to " + to_text(*due.not_after) : "or later");
}

// The command that prints the plates which are to be reprinted; empty when there are none.
std::string print_command_for(const Survey& survey, const LedgerReport& report) {
  const std::vector<std::string> tags = plates_to(PlateAction::reprint, survey, report);
  if (tags.empty()) return {};
  return fmt::format("tagsmith print {} --tags {} -o print", shell_word(survey.file.string()),
                     shell_word(fmt::format("{}", fmt::join(tags, ","))));
}

// ---- The ledger as one web page: what to do now, then what to plan, then all plates.

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

// What must be done now.
constexpr std::array kNow{PlateAction::reprint, PlateAction::clean, PlateAction::rehang,
                          PlateAction::look};

// What the word means for the person who does it.
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
  for (const PlateAction action : kNow) rows += action_rows(report, action);
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
  return page_table("<th>tag</th><th>what</th><th>at the limit on</th><th>now</th>", rows);
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
  return page_table("<th>tag</th><th>in order on</th><th>what it was</th><th>last found</th>",
                    rows);
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
    "more; or it failed on the last day alone; or it or another plate hangs wrong; or "
    "dates, distances or the camera may be what changed.</li>\n</ul></details>\n";

std::string ledger_page(const Survey& survey, const LedgerReport& report) {
  return page_head("Ledger of " + markup_text(survey.name),
                   std::string(report_style()) + kLedgerStyle, false) +
         heading(survey, report) + "<h2>To do now</h2>\n" + now_text(survey, report) +
         "<h2>To plan</h2>\n" + plan_text(report) + "<h2>Mended</h2>\n" + mended_text(report) +
         "<h2>In no photo with a date</h2>\n" + unseen_text(survey, report) +
         "<h2>All plates, the most urgent first</h2>\n" +
         page_table(
             "<th>tag</th><th>what</th><th>grade</th><th>its days</th>"
             "<th>at the limit on</th><th>last seen</th><th class=\"more\">photos</th>",
             plate_rows(report)) +
         kLegend + "</body>\n</html>\n";
}

// ---- The report.

double rounded(double value) { return with_decimals(value, 4); }

Json to_json(const std::optional<Day>& day) { return day ? Json(to_text(*day)) : Json(); }

Json to_json(const PlateDue& due) {
  constexpr double kYear = 365.25;
  return {{"parameter", to_string(due.parameter)},
          {"value", rounded(due.trend.at(due.trend.last))},
          {"limit", due.limit},
          {"slope_per_year", rounded(kYear * due.trend.slope)},
          {"scatter", rounded(due.trend.scatter)},
          {"not_before", to_text(due.not_before)},
          {"expected", to_json(due.expected)},
          {"not_after", to_json(due.not_after)}};
}

Json to_json(const PlateQuality& day) {
  Json object{{"date", to_text(day.day)},
              {"grade", rounded(day.grade)},
              {"module_px", rounded(day.module_px)}};
  for (std::size_t i = 0; i < day.values.size(); ++i) {
    if (day.values[i]) object[to_string(kWearParameters[i])] = rounded(*day.values[i]);
  }
  return object;
}

Json to_json(const MendedFault& fault) {
  return {{"tag", fault.tag},
          {"rule", fault.rule.empty() ? Json() : Json(fault.rule)},
          {"last_found", to_json(fault.last_found)},
          {"in_order", to_text(fault.in_order)}};
}

Json to_json(const PlateState& plate);

template <class Items>
Json list_of(const Items& items) {
  return json_list(items, [](const auto& item) { return to_json(item); });
}

Json to_json(const PlateState& plate) {
  Json object{{"tag", plate.tag}, {"action", to_string(plate.action)}};
  if (!plate.reason.empty()) object["reason"] = plate.reason;
  if (plate.cure) object["cure"] = to_string(*plate.cure);
  object["last_seen"] = to_json(plate.last_seen);
  object["photos"] = plate.photos;
  object["undated"] = plate.undated;
  if (plate.offset_mm) {
    object["offset_mm"] = json_list(*plate.offset_mm, rounded);
  }
  object["due"] = plate.due ? to_json(*plate.due) : Json();
  object["series"] = list_of(plate.series);
  return object;
}

std::string report_line(const Survey& survey, const LedgerReport& report) {
  Json object{{"survey", survey.name},
              {"revision", survey_revision(survey)},
              {"photos", report.photos.photos},
              {"undated", report.photos.undated},
              {"future", report.photos.future},
              {"clock_reset", report.photos.clock_reset},
              {"other_revisions", report.photos.other_revisions},
              {"mixed_revisions", report.photos.mixed_revisions},
              {"nameless", report.nameless},
              {"oldest", to_json(report.oldest)},
              {"newest", to_json(report.newest)},
              {"trends", report.trends},
              {"falling", report.falling},
              {"losing_light", report.losing_light},
              {"blames_camera", report.blames_camera()}};
  for (std::size_t i = 0; i < kPlateActions; ++i) {
    const auto action = static_cast<PlateAction>(i);
    if (action != PlateAction::none) {
      object[to_string(action)] = plates_to(action, survey, report);
    }
  }
  object["mended"] = list_of(report.mended);
  object["plates"] = list_of(report.plates);
  return json_text({{"ledger", object}});
}

void print_in_words(const Survey& survey, const LedgerReport& report) {
  to_stdout("{} of {}{}\n", counted(report.photos.photos, "photo"), survey.name,
            days_in_words(report));
  for (const std::string& sentence : doubts_in_words(report)) to_stdout("{}\n", sentence);
  if (report.blames_camera()) to_stdout("{}\n", camera_in_words(report));
  std::size_t without = 0;
  for (const PlateState& plate : report.plates) {
    if (plate.action == PlateAction::plan) {
      to_stdout("{} by {}: {} ({}; at the limit: {})\n", to_string(*plate.cure),
                to_text(plate.due->not_before), plate.tag, plate.reason, due_in_words(plate));
    } else if (plate.action < PlateAction::plan) {
      to_stdout("{} now: {} ({})\n", to_string(plate.action), plate.tag, plate.reason);
    }
    if (!plate.due && plate.action != PlateAction::unseen) ++without;
  }
  for (const MendedFault& fault : report.mended) {
    to_stdout("mended on {}: {} ({} until {})\n", to_text(fault.in_order), fault.tag,
              fault.rule.empty() ? "low grade" : fault.rule, last_found_in_words(fault));
  }
  if (without > 0) {
    to_stdout(
        "no trend yet: {} tags, {} days with a grade from about the same distance are needed\n",
        without, kLeastTrendDays);
  }
  const auto unseen = plates_to(PlateAction::unseen, survey, report);
  if (!unseen.empty()) to_stdout("in no photo with a date: {}\n", fmt::join(unseen, " "));
  const std::string print = print_command_for(survey, report);
  if (!print.empty()) to_stdout("print again: {}\n", print);
}

// Tomorrow, because farther east it is that day already.
Day last_possible_day() {
  return std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now()) +
         std::chrono::days(1);
}

Result<void> enter_lines(const LedgerOptions& options, const Survey& survey) {
  // First, so that a name with a mistake makes no ledger.
  for (const std::string& lines : options.lines) {
    if (const auto whole = read_own_lines(lines, [](const VerifiedFile&) {}); !whole) {
      return fail(whole);
    }
  }
  Result<LedgerWriter> ledger = LedgerWriter::open(options.ledger, survey.name);
  if (!ledger) return fail(ledger);
  for (const std::string& lines : options.lines) {
    Result<void> entered;
    const auto counts = read_own_lines(lines, [&](const VerifiedFile& file) {
      if (entered) entered = ledger->add(file);
    });
    if (!counts) return fail(counts);
    if (!entered) return entered;
    report_broken_lines(lines, *counts);
  }
  if (auto written = ledger->flush(); !written) return written;
  ledger->print_tally();
  return {};
}

// A report of nothing would look like one of a tunnel in order.
Result<void> check_has_survey(const LedgerOptions& options, const Survey& survey,
                              const Ledger& ledger) {
  const Result<std::vector<std::string>> names = ledger.surveys();
  if (!names) return fail(names);
  if (names->empty() || std::ranges::find(*names, survey.name) != names->end()) return {};
  return fail(
      fmt::format("{}: has no photos of the survey {}, but of {}: give that survey, or enter "
                  "photos of this one "
                  "with `tagsmith verify --ledger`",
                  options.ledger, survey.name, fmt::join(*names, ", ")));
}

}  // namespace

void add_ledger_files(const std::string& ledger, CommandFiles& files) {
  files.writes(ledger, "--ledger");
  if (!ledger.empty()) files.writes(ledger + "-journal", "the journal of --ledger");
}

Result<LedgerWriter> LedgerWriter::open(const std::string& path, const std::string& survey) {
  LedgerWriter writer;
  writer.path_ = path;
  writer.survey_ = survey;
  if (path.empty()) return writer;
  Result<Ledger> ledger = Ledger::open_to_write(path);
  if (!ledger) return fail(ledger);
  writer.ledger_ = std::move(*ledger);
  return writer;
}

Result<void> LedgerWriter::add(const VerifiedFile& file) {
  constexpr std::size_t kMostWaiting = 500;
  constexpr std::chrono::seconds kLongest{1};
  if (!ledger_) return {};
  waiting_.push_back(file);
  const bool is_time = std::chrono::steady_clock::now() - flushed_ > kLongest;
  return is_time || waiting_.size() >= kMostWaiting ? flush() : Result<void>{};
}

Result<void> LedgerWriter::flush() {
  if (!ledger_ || waiting_.empty()) return {};
  const Result<LedgerTally> entered = ledger_->enter(survey_, waiting_);
  waiting_.clear();
  flushed_ = std::chrono::steady_clock::now();
  if (!entered) {
    ledger_.reset();
    return fail(entered);
  }
  tally_.added += entered->added;
  tally_.replaced += entered->replaced;
  tally_.known += entered->known;
  tally_.undated += entered->undated;
  return {};
}

void LedgerWriter::print_tally() const {
  if (path_.empty()) return;
  to_stderr("{}: {} added, {} replaced, {} known\n", path_, counted(tally_.added, "photo"),
            tally_.replaced, tally_.known);
  if (tally_.undated > 0) {
    to_stderr("{}: {} of these say no date (EXIF, or `time` of the run): they are in no trend\n",
              path_, tally_.undated);
  }
}

Result<int> report_ledger(const LedgerOptions& options) {
  const Result<Survey> survey = load_survey(options.survey);
  if (!survey) return fail(survey);
  CommandFiles files;
  files.reads(*survey);
  for (const std::string& lines : options.lines) files.reads(lines, "the lines");
  if (options.lines.empty()) {
    files.reads(options.ledger, "--ledger");
  } else {
    add_ledger_files(options.ledger, files);
  }
  files.writes(options.html, "--html");
  if (const auto usable = files.check(); !usable) return fail(usable);
  if (!options.lines.empty()) {
    if (auto entered = enter_lines(options, *survey); !entered) {
      return fail(entered);
    }
  }
  const Result<Ledger> ledger = Ledger::open_to_read(options.ledger);
  if (!ledger) return fail(ledger);
  if (const auto has = check_has_survey(options, *survey, *ledger); !has) return fail(has);
  const Result<LedgerReport> report = make_ledger_report(*survey, *ledger, last_possible_day());
  if (!report) return fail(report);
  if (!options.html.empty()) {
    const auto written = publish_files({{options.html, ledger_page(*survey, *report)}});
    if (!written) return fail(written);
  }
  if (options.json) {
    to_stdout("{}\n", report_line(*survey, *report));
  } else {
    print_in_words(*survey, *report);
  }
  const bool is_well = std::ranges::all_of(
      kNow, [&](PlateAction action) { return plates_to(action, *survey, *report).empty(); });
  return is_well ? kExitOk : kExitFindings;
}

}  // namespace tagsmith::detail
