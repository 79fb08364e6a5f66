// SPDX-License-Identifier: Apache-2.0
// The common parts of web pages without further files.
#pragma once

#include <string>

namespace tagsmith::detail {

// Everything up to the begin of the body. `title` is markup; `style` follows the common style:
// colours, headings, tables. The page can load nothing, whatever the names in it say, and runs
// scripts only if it has one.
std::string page_head(const std::string& title, const std::string& style, bool has_script);

// A table that scrolls separately where the page is narrow, of cells <th> and rows <tr>.
std::string page_table(const std::string& head, const std::string& rows);

// For pages that report tags: cards and maps, also in the dark scheme.
const char* report_style();

}  // namespace tagsmith::detail
