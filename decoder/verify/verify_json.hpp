// SPDX-License-Identifier: Apache-2.0
// The JSON lines of `verify` and `report` (docs/formats.md), written and read back. Each function
// returns one line without its line end; bytes of file names that are no UTF-8 become U+FFFD.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "decoder/plates/hung_tags.hpp"
#include "decoder/verify/verified_file.hpp"
#include "decoder/verify/verify_merge.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

std::string to_json_line(const VerifiedFile& file);

// What to_json_line wrote; nothing for any other text.
std::optional<VerifiedFile> verified_file_from(std::string_view line);

// The value that to_string() calls so, of an enumeration of so many; nothing where it calls none
// so.
template <class Enum>
std::optional<Enum> value_named(std::string_view name, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (to_string(static_cast<Enum>(i)) == name) return static_cast<Enum>(i);
  }
  return std::nullopt;
}

// The summary of `verify`. `hung`: where tags hang, when that was asked for. `skipped`: how many
// files of which kind the folders hold besides.
std::string verify_summary_line(const Survey& survey, const VerifyMerge& merged,
                                const std::optional<HungTags>& hung,
                                const std::map<std::string, std::size_t>& skipped);

// The summary of `report`.
std::string report_summary_line(const Survey& survey, const VerifyMerge& merged,
                                const std::optional<HungTags>& hung);

struct VerifyLineCounts {
  std::size_t files = 0;
  std::size_t broken = 0;  // lines that are no JSON of verify, such as one cut short by a crash
};

// Calls `take` with every file's line in turn; summaries and empty lines are skipped. One line at a
// time is in memory. Fails when the file cannot be read or has a line of more than 64 MiB.
Result<VerifyLineCounts> read_verify_lines(const std::filesystem::path& path,
                                           const std::function<void(VerifiedFile)>& take);

}  // namespace tagsmith::detail
