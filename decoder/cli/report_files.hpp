// SPDX-License-Identifier: Apache-2.0
// A report of verified files, for people: table, web page, document.
#pragma once

#include <string>
#include <vector>

#include "decoder/cli/verify_merge.hpp"
#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet.hpp"

namespace CLI {
class App;
}

namespace tagsmith {

// Files to write; empty = none.
struct ReportFiles {
  std::string html;
  std::string pdf;
  std::string csv;

  bool shows_pictures() const { return !html.empty() || !pdf.empty(); }
};

// --html, --pdf and --csv.
void add_report_options(CLI::App& app, ReportFiles& files);

// Writes what is asked for, each file whole or not at all.
Result<void> write_report(const ReportFiles& files, const Survey& survey,
                          const VerifyMerge& merged);

// A line a tag of the survey: tag, digits, chainage_m, status, seen, faults, best_grade,
// worst_grade, blame, side.
std::string report_csv(const Survey& survey, const VerifyMerge& merged);

// The report as one web page that needs nothing else.
std::string report_page(const Survey& survey, const VerifyMerge& merged);

// The report as a document: summary and map, faults with their pictures, all tags. Fails as
// lay_out_sheets does.
Result<std::vector<Sheet>> draw_report(const Survey& survey, const VerifyMerge& merged);

// A crop as a small JPEG for a report; empty when it cannot be encoded.
std::string report_picture(const GrayView& crop);

// Fills the pictures of faults whose crops were saved: at the path as written, or in that folder or
// its `crops` beside `lines`, the file of JSON lines that names it. Those that cannot be read, and
// all beyond kMostPictureBytes, stay empty.
void load_pictures(VerifyMerge& merged, const std::vector<std::string>& lines);

// In words: "14 of 16 tags seen (88 %), ..." and one line for each stretch that was not, at most
// `most` of them.
std::vector<std::string> completeness_words(const Completeness& covered, std::size_t most);

}  // namespace tagsmith
