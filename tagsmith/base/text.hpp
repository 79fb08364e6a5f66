// SPDX-License-Identifier: Apache-2.0
// Small text functions that several modules share: reading, writing and comparing text, and making
// text from outside harmless.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tagsmith::detail {

// The text without spaces, tabs and line ends at both ends.
std::string_view trim(std::string_view text);

bool is_digit(char c);

// ASCII letters in lower or upper case; other characters stay.
std::string lower_case(std::string_view text);
std::string upper_case(std::string_view text);

// The text in single quotes, those within doubled, as YAML and SQL have them.
std::string single_quoted(std::string_view text);

// The text as a shell takes it for one word: in quotes where it is not plain.
std::string shell_word(std::string_view text);

// The words between blanks, tabs and line ends.
std::vector<std::string> split_words(std::string_view text);

// The fields between the separators; an empty text has one empty field.
std::vector<std::string> split(std::string_view text, char separator);

// A finite number written in full ("1.5", "-2e3"); nothing for anything else, "nan", "inf",
// "0x10" and trailing text included. Independent of the locale.
std::optional<double> parse_number(std::string_view text);

// A whole number written in full, in the range of int.
std::optional<int> parse_integer(std::string_view text);

// `value` in fixed notation with at most `decimals` digits, trailing zeros dropped: 1.5, 0.04, 3.
std::string format_number(double value, int decimals = 6);

// "1 file", "3 files", of a noun whose plural has an s.
std::string counted(std::size_t count, std::string_view noun);

// "000L 000R 001L and 13 more": eight names at most.
std::string listed(std::span<const std::string> names);

// A length in millimetres: 343, 0.264.
std::string mm_text(double metres, int decimals = 3);

// The candidate nearest to `word` by edit distance, when it is near enough to be a typing error (a
// third of the word's length, at least 1).
std::optional<std::string> nearest_word(std::string_view word,
                                        std::span<const std::string> candidates);

// ---- Text from outside (file names, names in files, messages of libraries) made harmless for the
// place where it is shown: the terminal, a page. Spreadsheets: csv.hpp.

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

// ---- Bytes.

// Bytes as text for data URIs (RFC 4648, section 4).
std::string base64(std::string_view bytes);

}  // namespace tagsmith::detail
