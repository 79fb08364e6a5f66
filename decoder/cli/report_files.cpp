// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/report_files.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "decoder/image/load.hpp"
#include "decoder/image/transform.hpp"
#include "decoder/verify/crop_tags.hpp"
#include "decoder/verify/verify_file.hpp"
#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/command_files.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/sheet_files.hpp"

namespace tagsmith::detail {
namespace {

namespace fs = std::filesystem;

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", *value) : std::string();
}

// What is wrong with each tag, each thing once.
std::map<std::string, std::string> findings_by_tag(const VerifyMerge& merged) {
  std::map<std::string, std::string> findings;
  for (const FaultRecord& fault : merged.faults) {
    std::string& words = findings[fault.tag];
    if (words.find(fault.message) != std::string::npos) continue;
    words += (words.empty() ? "" : "; ") + fault.message;
  }
  return findings;
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

// The photo that was cut from last: faults of one come one after the other.
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

// A fault that no crop was saved of, cut out of its photo, or why it cannot be.
Result<std::string> cut_from_photo(const FaultRecord& fault, const std::vector<std::string>& lines,
                                   CutPhoto& last, CommandFiles& files) {
  const bool is_in_photo = fault.corners || (fault.shows_whole && !fault.sha256.empty());
  if (!is_in_photo) return fail("no crop of it was saved when it was verified");
  if (last.file != fault.file) last = {fault.file, load_photo(fault, lines, files)};
  if (!last.image) return fail(last.image.error().message);
  if (fault.shows_whole) {
    return report_picture(small_picture(last.image->view(), fault.orientation).view());
  }
  const auto crop = crop_around(last.image->view(), *fault.corners, fault.orientation);
  if (!crop) return fail("its corners lie outside of the photo");
  return report_picture(crop->view());
}

// The picture that was saved of a fault, or else a new one.
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
    if (!sheets) return fail(sheets.error().message);
    Result<std::string> pdf = render_pdf(*sheets);
    if (!pdf) return fail(pdf.error().message);
    written.push_back({report.pdf, std::move(*pdf)});
  }
  return publish_files(written);
}

std::string report_csv(const Survey& survey, const VerifyMerge& merged) {
  std::string csv =
      csv_row({"tag", "digits", "chainage_m", "status", "seen", "faults", "best_grade",
               "worst_grade", "blame", "side", "upright", "finding", "placement"});
  const std::map<std::string, std::string> findings = findings_by_tag(merged);
  for (const PlacedTag& tag : survey.tags) {
    const TagRecord record = record_of(merged, tag.name);
    const auto finding = findings.find(tag.name);
    csv +=
        csv_row({tag.name, to_string(tag.digits), format_number(tag.chainage, 3), status_of(record),
                 std::to_string(record.seen), std::to_string(record.faults), number(record.best),
                 number(record.worst), record.blame, to_string(tag.side), upright_of(record),
                 finding == findings.end() ? "" : finding->second, placement_of(record)});
  }
  return csv;
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

void tell_broken_lines(const std::string& file, const VerifyLineCounts& counts) {
  if (counts.broken == 0) return;
  to_stderr("{}: {} not of `verify --json` and left out\n", file,
            counts.broken == 1 ? "1 line is" : fmt::format("{} lines are", counts.broken));
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
