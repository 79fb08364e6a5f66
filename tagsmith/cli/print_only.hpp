// SPDX-License-Identifier: Apache-2.0
// The tags that a list requests to print.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// What a list requests to print.
struct TagsToPrint {
  std::vector<std::string> names;
  std::vector<std::string> moved{};  // tags whose plates stay and hang elsewhere
  std::string revision{};  // the state of the survey that the list was made for; empty = not stated
};

// Begins the line of a list in words that says the survey's revision.
inline constexpr std::string_view kRevisionLine = "# for revision ";

// The requests in a file ("-" = `standard_input`), a name a line: alone, or as `tagsmith diff`
// writes them, in words or with --json. Of a diff's lines those with print or reprint count; move
// requests no print but a new place, remove requests neither. Empty lines and lines that begin with
// # are skipped. Fails on other lines.
Result<TagsToPrint> read_tags_to_print(const std::string& path, std::istream& standard_input);

}  // namespace tagsmith::detail
