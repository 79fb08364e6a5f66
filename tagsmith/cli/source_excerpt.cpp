// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/source_excerpt.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kLongestExcerpt = 96;  // bytes

// The line with this number, 1-based, without its end.
std::optional<std::string_view> line_of(std::string_view text, int number) {
  for (int line = 1; line < number; ++line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    text.remove_prefix(end + 1);
  }
  text = text.substr(0, text.find('\n'));
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80; }

std::size_t character_count(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return !continues_character(c); }));
}

// Bytes of the word, number or quoted text that begins the text; at least 1.
std::size_t token_length(std::string_view text) {
  if (text.empty()) return 1;
  if (text.front() == '"' || text.front() == '\'') {
    const std::size_t end = text.find(text.front(), 1);
    return end == std::string_view::npos ? text.size() : end + 1;
  }
  return std::max<std::size_t>(1, std::min(text.find_first_of(" \t,:[]{}#"), text.size()));
}

}  // namespace

std::string source_excerpt(const Diagnostic& diagnostic, std::string_view text) {
  if (diagnostic.line <= 0 || diagnostic.column <= 0 || diagnostic.code == "not-utf-8") return {};
  const std::optional<std::string_view> line = line_of(text, diagnostic.line);
  const auto column = static_cast<std::size_t>(diagnostic.column) - 1;
  if (!line || column > line->size()) return {};
  std::string untabbed(*line);
  std::ranges::replace(untabbed, '\t', ' ');
  if (!is_plain_text(untabbed)) return {};
  const bool fits = line->size() <= kLongestExcerpt;
  std::size_t begin = fits || column < kLongestExcerpt / 2 ? 0 : column - kLongestExcerpt / 2;
  while (begin > 0 && continues_character((*line)[begin])) --begin;
  std::size_t end = std::min(line->size(), begin + kLongestExcerpt);
  while (end < line->size() && continues_character((*line)[end])) ++end;
  const std::size_t length =
      diagnostic.fix ? diagnostic.fix->found.size() : token_length(line->substr(column));
  const std::string_view marked = line->substr(column, std::min(length, end - column));
  const std::string shown = untabbed.substr(begin, end - begin);
  const std::size_t before = character_count(line->substr(begin, column - begin));
  const std::size_t under = std::max<std::size_t>(1, character_count(marked));
  return fmt::format("{:5} | {}\n      | {:>{}}{}\n", diagnostic.line, shown, "^", before + 1,
                     std::string(under - 1, '~'));
}

std::string FindingPrinter::text_of(const Diagnostic& diagnostic) {
  const auto [entry, is_new] = texts_.try_emplace(diagnostic.file);
  if (is_new) entry->second = read_file(diagnostic.file).value_or("");
  Diagnostic headline = diagnostic;
  headline.hint.clear();
  std::string text = to_string(headline) + "\n" + source_excerpt(diagnostic, entry->second);
  if (!diagnostic.hint.empty()) text += "    " + terminal_text(diagnostic.hint) + "\n";
  return text;
}

}  // namespace tagsmith::detail
