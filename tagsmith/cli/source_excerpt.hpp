// SPDX-License-Identifier: Apache-2.0
// A finding together with the text that it is about.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "tagsmith/base/diagnostic.hpp"

namespace tagsmith::detail {

// The line of the finding with its number, and the offending text underlined below it; each line
// ends with a line feed. Of a long line only the part around the finding. Empty when the finding
// has no line in the text, or the line is not printable.
std::string source_excerpt(const Diagnostic& diagnostic, std::string_view text);

// Findings as text, each with the excerpt of its file between its message and its remedy. Reads
// each file once; a file that cannot be read has no excerpts.
class FindingPrinter {
 public:
  std::string text_of(const Diagnostic& diagnostic);

 private:
  std::map<std::string, std::string> texts_;  // by file
};

}  // namespace tagsmith::detail
