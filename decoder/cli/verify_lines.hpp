// SPDX-License-Identifier: Apache-2.0
// The JSON lines of `verify --json`, read back.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "decoder/verify/finding.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith {

struct VerifiedTag {
  std::string tag;  // the survey's name; empty when it has none
  std::string status;
  std::string rule;
  std::string message;
  std::string remedy;
  std::string crop;
  std::optional<double> grade;
  std::string blame;
  bool of_hanging = false;  // status and message are of where it hangs
  bool is_placed = false;   // it was judged for where it hangs
  bool fits = false;        // so it was, and hangs as surveyed
  bool is_read = false;
  std::optional<FrameCorners> corners{};                   // in photos; pixels as stored
  CornerCovariance covariance = CornerCovariance::Zero();  // zero = not estimated
};

// One line: what `verify` said about one file.
struct VerifiedFile {
  std::string file;
  std::string sha256;
  std::string revision;  // of the survey
  std::vector<VerifiedTag> tags;
  std::vector<std::string> findings;
  std::vector<std::string> rules;
  bool stale = false;
  int width = 0;  // of a photo, pixels; 0 for print files
  int height = 0;
  std::optional<int> orientation{};  // of a photo (EXIF)
  UpSource up = UpSource::unknown;
  std::vector<std::string> notes{};
  std::string picture{};  // file of the small picture of a photo, or a page, without a tag
};

struct VerifyLineCounts {
  std::size_t files = 0;
  std::size_t broken = 0;  // lines that are no JSON of verify, such as one cut short by a crash
};

// What the report's line would say.
VerifiedFile verified_file(const FileReport& report);

// What the line says, without grades: for the tally of a run, and to check where tags hang.
FileReport report_of(const VerifiedFile& file);

// Puts what a later check found, in a report_of the line, into the line.
void take_findings(const FileReport& report, VerifiedFile& file);

// Takes out what an earlier check said of where tags hang: they are in order again.
void forget_hanging(VerifiedFile& file);

// Calls `take` with every file's line in turn; summaries and empty lines are passed over. One line
// at a time is in memory. Fails when the file cannot be read or has a line of more than 64 MiB.
Result<VerifyLineCounts> read_verify_lines(const std::filesystem::path& path,
                                           const std::function<void(const VerifiedFile&)>& take);

// Says on standard error how many lines of `file` were left out, when there are any.
void tell_broken_lines(const std::string& file, const VerifyLineCounts& counts);

// What is wrong with writing to standard output while the lines of `path` are resumed; nothing in
// most cases. When both are one file, standard output must append to it, and a last line that a
// killed run left without its end is cut off, so that the next one begins a line.
Result<void> prepare_to_append(const std::filesystem::path& path);

}  // namespace tagsmith
