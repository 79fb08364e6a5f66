// SPDX-License-Identifier: Apache-2.0
// What web pages have in common that need nothing but themselves.
#pragma once

#include <string>

namespace tagsmith::detail {

// All up to the begun body. `title` is markup; `style` follows what all pages have: colours,
// headings, tables. The page can load nothing, whatever the names in it say, and runs scripts only
// if it has one.
std::string page_head(const std::string& title, const std::string& style, bool has_script);

// A table that scrolls by itself where the page is narrow, of cells <th> and rows <tr>.
std::string page_table(const std::string& head, const std::string& rows);

// Of pages that report tags: cards and maps, in the dark too.
const char* report_style();

}  // namespace tagsmith::detail
