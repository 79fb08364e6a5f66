// SPDX-License-Identifier: Apache-2.0
// Small text helpers that several modules share.
#pragma once

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

// A length in millimetres: 343, 0.264.
std::string mm_text(double metres, int decimals = 3);

// The candidate nearest to `word` by edit distance, when it is near enough to be a slip of the
// pen (a third of the word's length, at least 1).
std::optional<std::string> nearest_word(std::string_view word,
                                        std::span<const std::string> candidates);

}  // namespace tagsmith::detail
