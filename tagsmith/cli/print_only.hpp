// SPDX-License-Identifier: Apache-2.0
// The tags that a list asks to print.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// The names in a file ("-" = `standard_input`), one a line: alone, or as `tagsmith diff` writes
// them, in words or with --json. Of a diff's lines those that say print or reprint count; move and
// remove ask for no print. Empty lines and lines that begin with # are skipped. Fails on other
// lines.
Result<std::vector<std::string>> read_tags_to_print(const std::string& path,
                                                    std::istream& standard_input);

}  // namespace tagsmith::detail
