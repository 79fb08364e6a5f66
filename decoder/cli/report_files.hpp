// SPDX-License-Identifier: Apache-2.0
// A report of verified files, for people: table, web page, document.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/verify/verify_json.hpp"
#include "decoder/verify/verify_merge.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {

class CommandFiles;

// Files to write; empty = none.
struct ReportFiles {
  std::string html;
  std::string pdf;
  std::string csv;

  bool shows_pictures() const { return !html.empty() || !pdf.empty(); }
};

// --html, --pdf and --csv.
std::vector<CommandOption> report_options(ReportFiles& files);

// Names them as outputs of the command.
void add_report_files(const ReportFiles& report, CommandFiles& files);

// Writes what is requested, all files or none. Fails when one would replace a file that was read.
Result<void> write_report(const ReportFiles& report, const Survey& survey,
                          const VerifyMerge& merged, const CommandFiles& files);

// The report as a document: summary and map, faults with their pictures, all tags. Fails as
// lay_out_sheets does.
Result<std::vector<Sheet>> draw_report(const Survey& survey, const VerifyMerge& merged);

// A crop as a small JPEG for a report; empty when it cannot be encoded.
std::string report_picture(const GrayView& crop);

// Fills the pictures of faults of tags that have none yet: from the crop that was saved, at the
// path as written, or in that folder or its `crops` beside `lines`, the files of JSON lines; else
// cut out of the photo, if it is the one that was verified. Those that a report has no space for,
// and those that are not available, say why in `no_picture`. The files that are read are added to
// `files`.
void load_pictures(VerifyMerge& merged, const std::vector<std::string>& lines, CommandFiles& files);

// In words: "14 of 16 tags seen (88 %), ..." and one line for each stretch that was not, at most
// `most` of them.
std::vector<std::string> completeness_words(const Completeness& covered, std::size_t most);

// Reports on standard error how many lines of `file` were left out, when there are any.
void report_broken_lines(const std::string& file, const VerifyLineCounts& counts);

// read_verify_lines of a file that may be another program's: fails where no line is of `verify
// --json` and more than the one that a killed job leaves are broken.
Result<VerifyLineCounts> read_own_lines(const std::string& file,
                                        const std::function<void(VerifiedFile)>& take);

// The survey's tags by status, as status_of names it.
struct StatusCount {
  const char* status;
  std::size_t count;
};
std::array<StatusCount, 4> status_counts(const Completeness& covered);

// "3.4", or the other words where there is no grade.
std::string grade_text(const std::optional<double>& grade, const char* without);

// "000L: glare?"
std::string fault_heading(const FaultRecord& fault);

// "fits", the rule of a tag that is off, or "in doubt".
std::string verdict_text(const HungTag& tag);

// Its offset in mm, right, up and out, then its turn in degrees, clockwise, right edge out and top
// out: "+1.2 ± 0.3", and "-" where it was not measured.
std::array<std::string, 6> placement_cells(const HungTag& tag);

// What was not checked, and notes on files, at most `most` of these.
std::vector<std::string> unchecked_and_notes_words(const Completeness& covered,
                                                   const VerifyMerge& merged, std::size_t most);

}  // namespace tagsmith::detail
