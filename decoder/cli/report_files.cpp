// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/report_files.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "decoder/image/half_size.hpp"
#include "decoder/image/load.hpp"
#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/render/sheet_files.hpp"

namespace tagsmith {
namespace {

namespace fs = std::filesystem;

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", *value) : std::string();
}

// The crop's file, where it may have been copied together with the lines.
std::optional<fs::path> find_crop(const std::string& crop, const std::vector<std::string>& lines) {
  std::error_code ignored;
  if (fs::is_regular_file(crop, ignored)) return crop;
  for (const std::string& file : lines) {
    const fs::path folder = fs::path(file).parent_path();
    for (const fs::path& path : {folder / crop, folder / fs::path(crop).filename(),
                                 folder / "crops" / fs::path(crop).filename()}) {
      if (fs::is_regular_file(path, ignored)) return path;
    }
  }
  return std::nullopt;
}

}  // namespace

void add_report_options(CLI::App& app, ReportFiles& files) {
  app.add_option("--html", files.html, "Write the report as a web page that needs nothing else")
      ->type_name("FILE");
  app.add_option("--pdf", files.pdf, "Write the report as a document for the file")
      ->type_name("FILE");
  app.add_option("--csv", files.csv, "Write a table of the survey's tags")->type_name("FILE");
}

Result<void> write_report(const ReportFiles& files, const Survey& survey,
                          const VerifyMerge& merged) {
  if (!files.csv.empty()) {
    const Result<void> written = write_file(files.csv, report_csv(survey, merged));
    if (!written) return written;
  }
  if (!files.html.empty()) {
    const Result<void> written = write_file(files.html, report_page(survey, merged));
    if (!written) return written;
  }
  if (files.pdf.empty()) return {};
  const Result<std::vector<Sheet>> sheets = draw_report(survey, merged);
  if (!sheets) return fail(sheets.error().message);
  const Result<std::string> pdf = render_sheets_pdf(*sheets);
  if (!pdf) return fail(pdf.error().message);
  return write_file(files.pdf, *pdf);
}

std::string report_csv(const Survey& survey, const VerifyMerge& merged) {
  std::string csv = csv_row({"tag", "digits", "chainage_m", "status", "seen", "faults",
                             "best_grade", "worst_grade", "blame", "side"});
  for (const PlacedTag& tag : survey.tags) {
    const TagRecord record = record_of(merged, tag.name);
    csv += csv_row({tag.name, to_string(tag.digits), format_number(tag.chainage, 3),
                    status_of(record), std::to_string(record.seen), std::to_string(record.faults),
                    number(record.best), number(record.worst), record.blame, to_string(tag.side)});
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

void load_pictures(VerifyMerge& merged, const std::vector<std::string>& lines) {
  for (FaultRecord& fault : merged.faults) {
    if (fault.crop.empty() || !fault.jpeg.empty()) continue;
    if (merged.picture_bytes >= kMostPictureBytes) return;
    const std::optional<fs::path> path = find_crop(fault.crop, lines);
    if (!path) continue;
    const Result<GrayImage> crop = load_gray_image(*path);
    if (!crop) continue;
    fault.jpeg = report_picture(crop->view());
    merged.picture_bytes += fault.jpeg.size();
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

}  // namespace tagsmith
