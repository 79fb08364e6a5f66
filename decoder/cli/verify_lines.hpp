// SPDX-License-Identifier: Apache-2.0
// The JSON lines of `verify --json`, read back.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

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
};

// One line: what `verify` said about one file.
struct VerifiedFile {
  std::string file;
  std::string sha256;
  std::string revision;  // of the survey
  std::vector<VerifiedTag> tags;
  std::vector<std::string> findings;
  std::vector<std::string> rules;
};

struct VerifyLineCounts {
  std::size_t files = 0;
  std::size_t broken = 0;  // lines that are no JSON of verify, such as one cut short by a crash
};

// Calls `take` with every file's line in turn; summaries and empty lines are passed over. One line
// at a time is in memory. Fails when the file cannot be read.
Result<VerifyLineCounts> read_verify_lines(const std::filesystem::path& path,
                                           const std::function<void(const VerifiedFile&)>& take);

}  // namespace tagsmith
