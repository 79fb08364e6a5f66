// SPDX-License-Identifier: Apache-2.0
// Text from outside (file names, names in files, messages of libraries) made harmless for where it
// is shown: the terminal, a page. Spreadsheets: csv.hpp.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tagsmith::detail {

// Length of the UTF-8 sequence at the front of the text, 0 when it is none (RFC 3629, section 4).
std::size_t utf8_length(std::string_view text);

// True for UTF-8 without control characters: C0, DEL, C1, the line and paragraph separators, and
// those that change the direction of writing (embeddings, overrides and isolates), which can make
// a text look like another.
bool is_plain_text(std::string_view text);

// True for plain text that may name files and columns of tables too: begins with a letter or digit
// and has no / \\ , : or ".
bool is_plain_name(std::string_view text);

// The text on one line, control characters as \xNN up to DEL and as \uNNNN beyond, bytes that are
// no UTF-8 as \xNN. A JSON text stays valid: it has control characters beyond C0 in strings only.
std::string terminal_text(std::string_view text);

// As terminal_text, for text of several lines that the program made: line feeds stay.
std::string terminal_lines(std::string_view text);

// For the pages of PDF, SVG and HTML files: control characters become spaces, bytes that are no
// UTF-8 U+FFFD; at most 500 characters.
std::string printable_text(std::string_view text);

// printable_text for elements and quoted attributes of SVG and HTML: < > & " ' as entities.
std::string markup_text(std::string_view text);

}  // namespace tagsmith::detail
