// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/report_files.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/verify/crop_tags.hpp"
#include "decoder/verify/verify_file.hpp"
#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/web_page.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/side_line.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/render/tunnel_plan.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {

// ---- The report of verified files as one web page.

namespace {

using Eigen::Vector2d;

constexpr const char* kScript = R"js(
'use strict';
const field = document.getElementById('filter');
const rows = [...document.querySelectorAll('[data-row]')];
const buttons = [...document.querySelectorAll('[data-status]')];
let status = '';
function filter() {
  const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
  const shown = {tag: 0, fault: 0};
  for (const row of rows) {
    const text = (row.textContent + ' ' + (row.dataset.of || '')).toLowerCase();
    const kept = status === '' || row.dataset.of === status;
    row.hidden = !kept || !words.every(word => text.includes(word));
    shown[row.dataset.row] += row.hidden ? 0 : 1;
  }
  const count = (n, word) => n + ' ' + word + (n === 1 ? '' : 's');
  document.getElementById('shown').textContent =
    count(shown.fault, 'fault') + ' and ' + count(shown.tag, 'tag') + ' shown';
}
function choose(wanted) {
  status = status === wanted ? '' : wanted;
  for (const button of buttons) {
    button.setAttribute('aria-pressed', String(button.dataset.status === status));
  }
  filter();
}
for (const button of buttons) {
  button.addEventListener('click', () => choose(button.dataset.status));
}
for (const tag of document.querySelectorAll('.tag')) {
  const show = () => {
    if (status !== '') choose(status);
    field.value = tag.dataset.tag;
    filter();
    document.getElementById('shown').scrollIntoView({block: 'nearest'});
  };
  tag.addEventListener('click', show);
  tag.addEventListener('keydown', event => {
    if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); show(); }
  });
}
for (const crop of document.querySelectorAll('.crop')) {
  crop.addEventListener('click', () => {
    const large = crop.getAttribute('aria-expanded') !== 'true';
    crop.setAttribute('aria-expanded', String(large));
    crop.closest('.card').classList.toggle('wide', large);
  });
}
field.addEventListener('input', filter);
window.addEventListener('beforeprint', () => {
  for (const details of document.querySelectorAll('details')) details.open = true;
});
document.addEventListener('keydown', event => {
  if (event.key === '/' && document.activeElement !== field) { event.preventDefault(); field.focus(); }
  if (event.key === 'Escape') { field.value = ''; if (status !== '') choose(status); else filter(); }
});
filter();
)js";

constexpr double kMapWidth = 1000;  // of a strip, units of its picture

// A disc; faulty tags are diamonds and unseen ones rings, for readers who do not see the colours.
std::string shape_of(const std::string& status, const Vector2d& at) {
  if (status != "faulty") {
    return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"6\"/>", at.x(), at.y());
  }
  return fmt::format("<path d=\"M{:.1f} {:.1f}l8 8l-8 8l-8-8Z\"/>", at.x(), at.y() - 8);
}

// A strip of the tunnel in a picture's units, y down.
class StripPicture {
 public:
  StripPicture(const Survey& survey, const PlanStrip& strip) : survey_(survey), strip_(strip) {
    for (const Side side : {Side::left, Side::right}) {
      for (const Vector2d& point : line(wall_of(survey.tunnel, side))) box_.extend(point);
    }
    for (const PlacedTag* tag : tags()) box_.extend(place(*tag));
    scale_ = (kMapWidth - 2 * kBeside) / std::max(box_.sizes().x(), 1e-6);
    // A strip that runs mostly across would be far too high.
    scale_ = std::min(scale_, kMapWidth / std::max(box_.sizes().y(), 1e-6));
  }

  std::string svg(const VerifyMerge& merged) const {
    const double height = scale_ * box_.sizes().y() + 2 * kAbove + 4;
    std::string text = fmt::format(
        "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"group\" aria-label=\"Tunnel from {:.1f} to "
        "{:.1f} m\">\n",
        kMapWidth, height, strip_.from, strip_.to);
    for (const Side side : {Side::left, Side::right}) {
      text += "<path class=\"wall\" d=\"" + path(line(wall_of(survey_.tunnel, side))) + "\"/>\n";
    }
    text += "<path class=\"axis\" d=\"" + path(line(0)) + "\"/>\n";
    const bool names = are_names_apart();
    for (const double tick : plan_ticks(strip_)) text += tick_mark(tick, names);
    for (const PlacedTag* tag : tags()) text += mark(*tag, merged, names);
    return text + "</svg>\n";
  }

 private:
  static constexpr double kBeside = 44;  // for words
  static constexpr double kAbove = 32;

  Vector2d view(const Eigen::Vector3d& in_world) const {
    return strip_.view_from_world * Vector2d(in_world.head<2>());
  }
  Vector2d place(const PlacedTag& tag) const { return view(tag.world_from_plate.translation); }
  Vector2d on_picture(const Vector2d& at) const {
    return {kBeside + scale_ * (at.x() - box_.min().x()),
            kAbove + scale_ * (box_.max().y() - at.y())};
  }

  std::vector<const PlacedTag*> tags() const {
    std::vector<const PlacedTag*> here;
    for (const PlacedTag& tag : survey_.tags) {
      if (tag.chainage >= strip_.from && tag.chainage <= strip_.to) here.push_back(&tag);
    }
    return here;
  }

  Vector2d on_map(double chainage, double right) const {
    return view(point_beside(survey_.tunnel.centerline, chainage, right));
  }

  // A line beside the center line, `right` metres to its right.
  std::vector<Vector2d> line(const ChainageProfile& right) const {
    constexpr int kMost = 400;
    const int spans = std::clamp(static_cast<int>((strip_.to - strip_.from) / 0.5), 1, kMost);
    std::vector<Vector2d> points;
    for (int i = 0; i <= spans; ++i) {
      const double chainage = strip_.from + (strip_.to - strip_.from) * i / spans;
      points.push_back(on_map(chainage, right.at(chainage)));
    }
    return points;
  }

  std::string path(const std::vector<Vector2d>& points) const {
    std::string text;
    for (const Vector2d& point : points) {
      const Vector2d at = on_picture(point);
      text += fmt::format("{}{:.1f} {:.1f}", text.empty() ? "M" : "L", at.x(), at.y());
    }
    return text;
  }

  // Its chainage stands beyond the right wall, clear of the tags' discs and names.
  std::string tick_mark(double chainage, bool names) const {
    const double right = wall_of(survey_.tunnel, Side::right).at(chainage);
    const Vector2d at = on_picture(on_map(chainage, 0));
    const Vector2d wall = on_picture(on_map(chainage, right));
    const Vector2d outward = (wall - at).normalized();
    const double clear = names ? 28 : 19;
    const Vector2d words = wall + clear * outward + Vector2d(16 * outward.x(), 4);
    constexpr double kHalfText = 20;
    return fmt::format(
        "<path class=\"tick\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{} m</text>\n",
        at.x(), at.y(), wall.x(), wall.y(), std::clamp(words.x(), kHalfText, kMapWidth - kHalfText),
        words.y(), format_number(chainage, 2));
  }

  bool are_names_apart() const {
    constexpr double kRoom = 34;
    const auto count = static_cast<double>(tags().size());
    return count * kRoom / 2 <= kMapWidth;
  }

  std::string mark(const PlacedTag& tag, const VerifyMerge& merged, bool names) const {
    const std::string status = status_of(record_of(merged, tag.name));
    const std::string name = markup_text(tag.name);
    const Vector2d at = on_picture(place(tag));
    std::string text = fmt::format(
        "<g class=\"tag {0}\" data-tag=\"{1}\" tabindex=\"0\" role=\"button\" aria-label=\"{1}, "
        "{0}\"><title>{1}: {0}</title>{2}",
        status, name, shape_of(status, at));
    if (names) {
      // Outside of the tunnel as drawn.
      const CenterlinePoint middle = survey_.tunnel.centerline.at(tag.chainage);
      const bool above = at.y() < on_picture(view(middle.position)).y();
      text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                          at.x(), at.y() + (above ? -10 : 19), name);
    }
    return text + "</g>\n";
  }

  const Survey& survey_;
  const PlanStrip& strip_;
  Eigen::AlignedBox2d box_;
  double scale_ = 1;
};

std::string map_of(const Survey& survey, const VerifyMerge& merged) {
  std::string text;
  for (const PlanStrip& strip : plan_strips(survey)) {
    text += "<div class=\"map\">" + StripPicture(survey, strip).svg(merged) + "</div>\n";
  }
  return text;
}

std::string tag_rows(const Survey& survey, const VerifyMerge& merged) {
  std::string rows;
  for (const PlacedTag& tag : survey.tags) {
    const TagRecord record = record_of(merged, tag.name);
    const std::string status = status_of(record);
    rows += fmt::format(
        "<tr data-row=\"tag\" data-of=\"{1}\"><td>{0}</td><td class=\"{1}\">{1}</td>"
        "<td class=\"more\">{2:.2f}</td><td>{3}</td><td>{4}</td><td>{5}</td><td>{6}</td>"
        "<td class=\"more\">{7}</td><td class=\"more\">{8}</td></tr>\n",
        markup_text(tag.name), status, tag.chainage, record.seen, record.faults,
        grade_text(record.best, "-"), grade_text(record.worst, "-"), markup_text(record.blame),
        upright_of(record));
  }
  return rows;
}

std::string hanging_table(const VerifyMerge& merged) {
  if (merged.hung.empty()) return {};
  std::string rows;
  for (const auto& [name, tag] : merged.hung) {
    const char* verdict = tag.verdict == HangVerdict::fits  ? "ok"
                          : tag.verdict == HangVerdict::off ? "faulty"
                                                            : "poor";
    rows += fmt::format("<tr><td>{}</td><td class=\"{}\">{}</td>", markup_text(name), verdict,
                        markup_text(verdict_text(tag)));
    const std::array<std::string, 6> cells = placement_cells(tag);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      rows += (i < 3 ? "<td>" : "<td class=\"more\">") + cells[i] + "</td>";
    }
    rows += fmt::format("<td>{}</td></tr>\n", tag.stations);
  }
  return "<p class=\"sub\">Against the survey, as one sees them who "
         "faces the wall, with standard deviations; seen: places of the cameras that show the tag "
         "together with another.</p>\n" +
         page_table(
             "<th>tag</th><th>verdict</th><th>right, mm</th><th>up, mm</th><th>out, mm</th>"
             "<th class=\"more\">clockwise, &deg;</th>"
             "<th class=\"more\">right edge out, &deg;</th>"
             "<th class=\"more\">top out, &deg;</th><th>seen</th>",
             rows);
}

// Where the tags hang, as seen by a viewer who faces the wall; empty where that was not checked.
std::string hanging_text(const VerifyMerge& merged) {
  if (merged.hung.empty() && merged.hanging_remarks.empty()) return {};
  std::string text = "<h2>Where the tags hang</h2>\n";
  for (const std::string& remark : merged.hanging_remarks) {
    text += "<p class=\"known\">" + markup_text(remark) + "</p>\n";
  }
  return text + hanging_table(merged);
}

std::string fault_card(const FaultRecord& fault) {
  const Rule* rule = find_verify_rule(fault.rule);
  const std::string heading = markup_text(fault_heading(fault));
  std::string card =
      "<article class=\"card\" data-row=\"fault\" data-of=\"faulty\"><h3>" + heading + "</h3>";
  if (!fault.picture.jpeg.empty()) {
    card += "<button class=\"crop\" aria-expanded=\"false\" aria-label=\"Enlarge the picture of " +
            heading + "\"><img alt=\"\" src=\"data:image/jpeg;base64," +
            base64(fault.picture.jpeg) + "\"></button>";
  }
  if (!fault.no_picture.empty()) {
    card += "<p class=\"sub\">No picture: " + markup_text(fault.no_picture) + ".</p>";
  }
  card += "<p>" + markup_text(fault.message) + "</p>";
  if (rule != nullptr) card += "<p>" + markup_text(std::string(rule->remedy)) + "</p>";
  return card + "<p class=\"sub\">" + markup_text(fault.file) + "</p></article>\n";
}

std::string fault_cards(const VerifyMerge& merged) {
  if (merged.faults.empty()) return "<p>None.</p>\n";
  std::string cards = "<div class=\"cards\">\n";
  for (const FaultRecord& fault : faults_by_plate(merged)) cards += fault_card(fault);
  cards += "</div>\n";
  if (merged.fault_count > merged.faults.size()) {
    cards += fmt::format("<p>The first {} of {} faults are listed.</p>\n", merged.faults.size(),
                         merged.fault_count);
  }
  return cards;
}

std::string count_buttons(const Completeness& covered) {
  std::string text = "<div class=\"counts\" role=\"group\" aria-label=\"Tags by status\">\n";
  for (const auto& [status, count] : status_counts(covered)) {
    text += fmt::format(
        "<button class=\"{0}\" data-status=\"{0}\" aria-pressed=\"false\"><b>{1}</b>{0}</button>\n",
        status, count);
  }
  return text + "</div>\n";
}

std::string cover_bar(const char* wall, std::size_t seen, std::size_t tags) {
  return fmt::format(
      "<span>{0}</span><progress value=\"{1}\" max=\"{2}\" aria-label=\"{0}\"></progress>"
      "<span>{1} of {2}</span>\n",
      wall, seen, std::max<std::size_t>(tags, 1));
}

std::string completeness_text(const Completeness& covered, const VerifyMerge& merged) {
  constexpr std::size_t kMostNotes = 20;
  std::string text =
      fmt::format("<p>{} of {} tags were seen ({:.0f} %).</p>\n<div class=\"cover\">", covered.seen,
                  covered.tags, 100 * covered.share());
  text +=
      cover_bar("left wall", covered.left_seen, covered.left_tags) +
      cover_bar("right wall", covered.seen - covered.left_seen, covered.tags - covered.left_tags) +
      "</div>\n";
  for (const std::string& line : unchecked_and_notes_words(covered, merged, kMostNotes)) {
    text += "<p class=\"known\">" + markup_text(line) + "</p>\n";
  }
  if (covered.unseen.empty()) return text;
  constexpr std::size_t kMostOpen = 8;
  text += fmt::format("<details{}><summary>Not seen, {}</summary>\n<ul>\n",
                      covered.unseen.size() <= kMostOpen ? " open" : "",
                      counted(covered.unseen.size(), "place"));
  for (const UnseenStretch& stretch : covered.unseen) {
    text += "<li>" + markup_text(describe(stretch)) + "</li>\n";
  }
  return text + "</ul></details>\n";
}

std::string heading(const Survey& survey, const VerifyMerge& merged) {
  std::string text =
      "<h1>Verification of " + markup_text(survey.name) + "</h1>\n" +
      fmt::format("<p class=\"sub\">{}, {}; survey revision {}", counted(merged.files, "file"),
                  counted(merged.fault_count, "fault"), survey_revision(survey));
  if (merged.other_revisions > 0) {
    text += fmt::format("; {} files were verified against another state of the survey",
                        merged.other_revisions);
  }
  return text + "</p>\n";
}

// The report as one web page without further files.
std::string report_page(const Survey& survey, const VerifyMerge& merged) {
  const Completeness covered = completeness_of(survey, merged);
  return page_head("Verification of " + markup_text(survey.name), report_style(), true) +
         heading(survey, merged) + count_buttons(covered) + "<h2>Completeness</h2>\n" +
         completeness_text(covered, merged) + "<h2>Tunnel from above</h2>\n" +
         map_of(survey, merged) +
         "<div class=\"screen\"><label for=\"filter\">Show what has these words</label>\n"
         "<input id=\"filter\" type=\"search\" placeholder=\"unseen, 003L, glare\" "
         "autocomplete=\"off\">\n<p id=\"shown\" class=\"sub\" role=\"status\"></p></div>\n"
         "<h2>Faults</h2>\n" +
         fault_cards(merged) + "<h2>Tags</h2>\n" +
         page_table(
             "<th>tag</th><th>status</th><th class=\"more\">chainage, m</th><th>seen</th>"
             "<th>faults</th><th>best</th><th>worst</th><th class=\"more\">blame</th>"
             "<th class=\"more\">upright</th>",
             tag_rows(survey, merged)) +
         hanging_text(merged) + "<script>" + kScript + "</script>\n</body>\n</html>\n";
}

// ---- The files.

namespace fs = std::filesystem;

// What is wrong with each tag, each fault once.
std::map<std::string, std::string> findings_by_tag(const VerifyMerge& merged) {
  std::map<std::string, std::string> findings;
  for (const FaultRecord& fault : merged.faults) {
    std::string& words = findings[fault.tag];
    if (words.find(fault.message) != std::string::npos) continue;
    words += (words.empty() ? "" : "; ") + fault.message;
  }
  return findings;
}

// A line a tag of the survey: tag, digits, chainage_m, status, seen, faults, best_grade,
// worst_grade, blame, side, upright ("checked", "unchecked", or nothing when never in order),
// finding: what is wrong with it, in words, placement ("checked", "unchecked", or nothing).
std::string report_csv(const Survey& survey, const VerifyMerge& merged) {
  std::string csv =
      csv_row({"tag", "digits", "chainage_m", "status", "seen", "faults", "best_grade",
               "worst_grade", "blame", "side", "upright", "finding", "placement"});
  const std::map<std::string, std::string> findings = findings_by_tag(merged);
  for (const PlacedTag& tag : survey.tags) {
    const TagRecord record = record_of(merged, tag.name);
    const auto finding = findings.find(tag.name);
    csv += csv_row({tag.name, to_string(tag.digits), format_number(tag.chainage, 3),
                    status_of(record), std::to_string(record.seen), std::to_string(record.faults),
                    grade_text(record.best, ""), grade_text(record.worst, ""), record.blame,
                    to_string(tag.side), upright_of(record),
                    finding == findings.end() ? "" : finding->second, placement_of(record)});
  }
  return csv;
}

// A file that a line names, where it may have been copied together with the lines: as named, or in
// their folder or its `subfolder`.
std::optional<fs::path> find_beside(const std::string& name, const char* subfolder,
                                    const std::vector<std::string>& lines) {
  std::error_code ignored;
  if (fs::is_regular_file(name, ignored)) return name;
  for (const std::string& file : lines) {
    const fs::path folder = fs::path(file).parent_path();
    for (const fs::path& path : {folder / name, folder / fs::path(name).filename(),
                                 folder / subfolder / fs::path(name).filename()}) {
      if (fs::is_regular_file(path, ignored)) return path;
    }
  }
  return std::nullopt;
}

// The photo that was used last: faults of one photo come one after the other.
struct CutPhoto {
  std::string file;
  Result<GrayImage> image = fail("");
};

Result<GrayImage> load_photo(const FaultRecord& fault, const std::vector<std::string>& lines,
                             CommandFiles& files) {
  const std::optional<fs::path> path = find_beside(fault.file, "photos", lines);
  if (!path) return fail("the photo is not where the line says");
  files.reads(*path, "a photo of the lines");
  const Result<InputFile> input = read_input_file(*path);
  if (!input) return fail("the photo cannot be read");
  if (input->sha256 != fault.sha256) return fail("the photo was changed since it was verified");
  return decode_gray_image(fault.file, input->bytes);
}

// A fault of which no crop was saved, cut out of its photo, or why that is not possible.
Result<std::string> cut_from_photo(const FaultRecord& fault, const std::vector<std::string>& lines,
                                   CutPhoto& last, CommandFiles& files) {
  const bool is_in_photo = fault.corners || (fault.shows_whole && !fault.sha256.empty());
  if (!is_in_photo) return fail("no crop of it was saved when it was verified");
  if (last.file != fault.file) last = {fault.file, load_photo(fault, lines, files)};
  if (!last.image) return fail(last.image);
  if (fault.shows_whole) {
    return report_picture(small_picture(last.image->view(), fault.orientation).view());
  }
  const auto crop = crop_around(last.image->view(), *fault.corners, fault.orientation);
  if (!crop) return fail("its corners lie outside of the photo");
  return report_picture(crop->view());
}

// The picture that was saved of a fault, otherwise a new one.
Result<std::string> picture_of(const FaultRecord& fault, const std::vector<std::string>& lines,
                               CutPhoto& last, CommandFiles& files) {
  if (!fault.picture.file.empty()) {
    const std::optional<fs::path> path = find_beside(fault.picture.file, "crops", lines);
    if (path) files.reads(*path, "a crop of the lines");
    const Result<GrayImage> crop =
        path ? load_gray_image(*path) : Result<GrayImage>(fail("not found"));
    if (crop) return report_picture(crop->view());
  }
  return cut_from_photo(fault, lines, last, files);
}

}  // namespace

std::vector<CommandOption> report_options(ReportFiles& files) {
  return {
      file_option("--html", &files.html, "Write the report as a web page that needs nothing else"),
      file_option("--pdf", &files.pdf, "Write the report as PDF"),
      file_option("--csv", &files.csv, "Write a table of the survey's tags")};
}

void add_report_files(const ReportFiles& report, CommandFiles& files) {
  files.writes(report.html, "--html");
  files.writes(report.pdf, "--pdf");
  files.writes(report.csv, "--csv");
}

Result<void> write_report(const ReportFiles& report, const Survey& survey,
                          const VerifyMerge& merged, const CommandFiles& files) {
  if (auto usable = files.check(); !usable) return usable;
  std::vector<SheetFile> written;
  if (!report.csv.empty()) written.push_back({report.csv, report_csv(survey, merged)});
  if (!report.html.empty()) written.push_back({report.html, report_page(survey, merged)});
  if (!report.pdf.empty()) {
    const Result<std::vector<Sheet>> sheets = draw_report(survey, merged);
    if (!sheets) return fail(sheets);
    Result<std::string> pdf = render_pdf(*sheets);
    if (!pdf) return fail(pdf);
    written.push_back({report.pdf, std::move(*pdf)});
  }
  return publish_files(written);
}

std::string report_picture(const GrayView& crop) {
  constexpr int kMostWidth = 480;
  constexpr int kQuality = 80;
  GrayImage smaller;
  GrayView view = crop;
  while (view.width > kMostWidth && view.height > 1) {
    smaller = half_size(view);
    view = smaller.view();
  }
  return encode_gray_image("crop.jpg", view, kQuality).value_or("");
}

void load_pictures(VerifyMerge& merged, const std::vector<std::string>& lines,
                   CommandFiles& files) {
  CutPhoto last;
  for (FaultRecord& fault : merged.faults) {
    const bool is_of_tag = !fault.tag.empty() || fault.corners || !fault.picture.file.empty();
    if (!fault.picture.jpeg.empty() || (!is_of_tag && !fault.shows_whole)) continue;
    if (constexpr std::size_t kUsual = 16'384; !has_room(merged, fault, kUsual)) {
      fault.no_picture = "a report holds no more pictures";
      continue;
    }
    Result<std::string> picture = picture_of(fault, lines, last, files);
    if (picture) {
      take_picture(std::move(*picture), fault, merged);
    } else {
      fault.no_picture = picture.error().message;
    }
  }
}

std::vector<std::string> completeness_words(const Completeness& covered, std::size_t most) {
  std::vector<std::string> lines{fmt::format(
      "{} of {} tags seen ({:.0f} %): left wall {} of {}, right wall {} of {}", covered.seen,
      covered.tags, 100 * covered.share(), covered.left_seen, covered.left_tags,
      covered.seen - covered.left_seen, covered.tags - covered.left_tags)};
  for (const UnseenStretch& stretch : covered.unseen) {
    if (lines.size() > most) {
      lines.push_back(fmt::format("and {} more places", covered.unseen.size() - most));
      break;
    }
    lines.push_back("not seen: " + describe(stretch));
  }
  return lines;
}

void report_broken_lines(const std::string& file, const VerifyLineCounts& counts) {
  if (counts.broken == 0) return;
  to_stderr("{}: {} not of `verify --json` and left out\n", file,
            counts.broken == 1 ? "1 line is" : fmt::format("{} lines are", counts.broken));
}

Result<VerifyLineCounts> read_own_lines(const std::string& file,
                                        const std::function<void(VerifiedFile)>& take) {
  Result<VerifyLineCounts> counts = read_verify_lines(file, take);
  if (!counts || counts->files > 0 || counts->broken <= 1) return counts;
  return fail(fmt::format("{}: none of its {} lines is of `verify --json`", file, counts->broken));
}

std::array<StatusCount, 4> status_counts(const Completeness& covered) {
  return {{{"ok", covered.ok},
           {"poor", covered.poor},
           {"faulty", covered.faulty},
           {"unseen", covered.tags - covered.seen}}};
}

std::string grade_text(const std::optional<double>& grade, const char* without) {
  return grade ? fmt::format("{:.1f}", *grade) : without;
}

std::string fault_heading(const FaultRecord& fault) {
  return fmt::format("{}{}{}", fault.tag.empty() ? "" : fault.tag + ": ",
                     fault.rule.empty() ? "fault" : fault.rule, fault.is_question ? "?" : "");
}

std::string verdict_text(const HungTag& tag) {
  if (tag.verdict == HangVerdict::off) return tag.rule;
  return tag.verdict == HangVerdict::fits ? "fits" : "in doubt";
}

std::array<std::string, 6> placement_cells(const HungTag& tag) {
  std::array<std::string, 6> cells;
  cells.fill("-");
  if (tag.offset.sigma.isZero()) return cells;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    cells[at] =
        fmt::format("{:+.1f} ± {:.1f}", 1e3 * tag.offset.value[i], 1e3 * tag.offset.sigma[i]);
    cells[at + 3] =
        fmt::format("{:+.2f} ± {:.2f}", degrees(tag.turn.value[i]), degrees(tag.turn.sigma[i]));
  }
  return cells;
}

std::vector<std::string> unchecked_and_notes_words(const Completeness& covered,
                                                   const VerifyMerge& merged, std::size_t most) {
  std::vector<std::string> lines = unchecked_words(covered, merged);
  for (std::size_t i = 0; i < std::min(merged.notes.size(), most); ++i) {
    lines.push_back("note: " + merged.notes[i].file + ": " + merged.notes[i].note);
  }
  if (merged.note_count > most) {
    lines.push_back(fmt::format("and {} more notes", merged.note_count - most));
  }
  return lines;
}

}  // namespace tagsmith::detail
