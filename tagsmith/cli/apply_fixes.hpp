// SPDX-License-Identifier: Apache-2.0
// Mechanical remedies applied to a file; everything else in it, comments included, stays.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// A line that a remedy changed.
struct FixedLine {
  int line = 0;
  std::vector<std::string> codes;  // of the findings that it removes
  std::string before;
  std::string after;
};

struct FixedText {
  std::string text;
  std::vector<FixedLine> lines;
};

// The text with the remedies of these findings, all of one file. A remedy whose text is not found
// at its place is left out.
FixedText apply_fixes(const std::string& text, std::vector<Diagnostic> diagnostics);

// The same for a file, which is replaced as a whole when a remedy applies.
Result<std::vector<FixedLine>> fix_file(const std::string& path,
                                        const std::vector<Diagnostic>& diagnostics);

}  // namespace tagsmith::detail
