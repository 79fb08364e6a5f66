// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/text.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tagsmith::detail {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

// Levenshtein distance with one row of memory.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

template <class T>
std::optional<T> parse_whole(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  T value{};
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc() || rest != end) return std::nullopt;
  return value;
}

}  // namespace

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string upper_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return result;
}

std::string single_quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

std::string shell_word(std::string_view text) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./,-";
  if (text.find_first_not_of(kPlain) == std::string_view::npos) return std::string(text);
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::vector<std::string> split_words(std::string_view text) {
  std::vector<std::string> words;
  while (!(text = trim(text)).empty()) {
    const std::size_t end = std::min(text.find_first_of(kBlank), text.size());
    words.emplace_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return words;
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> fields;
  while (true) {
    const std::size_t end = text.find(separator);
    fields.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return fields;
    text.remove_prefix(end + 1);
  }
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<double> value = parse_whole<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<int> parse_integer(std::string_view text) { return parse_whole<int>(text); }

std::string format_number(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string listed(std::span<const std::string> names) {
  constexpr std::size_t kMost = 8;
  const std::size_t shown = std::min(names.size(), kMost);
  std::string text = fmt::format("{}", fmt::join(names.first(shown), " "));
  if (shown < names.size()) text += fmt::format(" and {} more", names.size() - shown);
  return text;
}

std::string mm_text(double metres, int decimals) { return format_number(metres * 1000, decimals); }

std::optional<std::string> nearest_word(std::string_view word,
                                        std::span<const std::string> candidates) {
  std::optional<std::string> nearest;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= least) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

// ---- Text from outside made harmless.

namespace {

// Longer texts would overflow Pango's 32-bit lengths, and fit nowhere.
constexpr int kMostPrintable = 500;  // characters

// A character at the front of a text.
struct Character {
  std::string_view bytes;
  bool is_utf8 = true;  // otherwise one byte that belongs to no character
  char32_t code = 0;    // Unicode
};

Character front_of(std::string_view text) {
  const std::size_t length = utf8_length(text);
  const auto lead = static_cast<unsigned char>(text.front());
  if (length == 0) return {text.substr(0, 1), false, lead};
  constexpr unsigned char kLeadBits[] = {0x7F, 0x1F, 0x0F, 0x07};
  char32_t code = lead & kLeadBits[length - 1];
  for (const char c : text.substr(1, length - 1)) {
    code = (code << 6U) | (static_cast<unsigned char>(c) & 0x3FU);
  }
  return {text.substr(0, length), true, code};
}

// Unicode 15, section 23.2 (controls, separators) and UAX #9 (directional formatting characters).
bool is_control(char32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x061C || code == 0x200E ||
         code == 0x200F || (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

// U+nFFFE and U+nFFFF are no characters (Unicode 15, section 23.7); XML forbids the first two.
bool is_noncharacter(char32_t code) { return (code & 0xFFFEU) == 0xFFFE; }

std::string spelt_out(std::string_view text, bool keeps_line_feeds) {
  std::string shown;
  for (Character c; !text.empty(); text.remove_prefix(c.bytes.size())) {
    c = front_of(text);
    if (!c.is_utf8 || (is_control(c.code) && c.code <= 0x7F)) {
      const bool stays = keeps_line_feeds && c.code == '\n';
      shown += stays ? "\n" : fmt::format("\\x{:02x}", static_cast<unsigned>(c.code));
    } else if (is_control(c.code)) {
      shown += fmt::format("\\u{:04x}", static_cast<unsigned>(c.code));
    } else {
      shown += c.bytes;
    }
  }
  return shown;
}

}  // namespace

std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  const std::size_t length = lead < 0x80   ? 1
                             : lead < 0xC2 ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  }
  if ((lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xED && byte(1) > 0x9F) ||
      (lead == 0xF0 && byte(1) < 0x90) || (lead == 0xF4 && byte(1) > 0x8F)) {
    return 0;
  }
  return length;
}

bool is_plain_text(std::string_view text) {
  for (Character c; !text.empty(); text.remove_prefix(c.bytes.size())) {
    c = front_of(text);
    if (!c.is_utf8 || is_control(c.code)) return false;
  }
  return true;
}

bool is_plain_name(std::string_view text) {
  if (text.empty() || !is_plain_text(text)) return false;
  const auto first = static_cast<unsigned char>(text.front());
  const bool begins_well = std::isalnum(first) != 0 || first >= 0x80;
  return begins_well && text.find_first_of("/\\,:\"") == std::string_view::npos;
}

std::string terminal_text(std::string_view text) { return spelt_out(text, false); }

std::string terminal_lines(std::string_view text) { return spelt_out(text, true); }

std::string printable_text(std::string_view text) {
  std::string printable;
  Character c;
  for (int count = 0; !text.empty() && count < kMostPrintable; ++count) {
    c = front_of(text);
    text.remove_prefix(c.bytes.size());
    const bool shown = !is_control(c.code) && !is_noncharacter(c.code);
    printable += !c.is_utf8 ? "\uFFFD" : shown ? c.bytes : " ";
  }
  return printable;
}

std::string markup_text(std::string_view text) {
  std::string markup;
  for (const char c : printable_text(text)) {
    switch (c) {
      case '<':
        markup += "&lt;";
        break;
      case '>':
        markup += "&gt;";
        break;
      case '&':
        markup += "&amp;";
        break;
      case '"':
        markup += "&quot;";
        break;
      case '\'':
        markup += "&#39;";
        break;
      default:
        markup += c;
    }
  }
  return markup;
}

// ---- Bytes.

std::string base64(std::string_view bytes) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t group = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      group =
          group << 8U | (at + i < bytes.size() ? static_cast<unsigned char>(bytes[at + i]) : 0U);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const bool padding = at + i > bytes.size();
      text += padding ? '=' : kLetters[group >> (18 - 6 * i) & 63U];
    }
  }
  return text;
}

}  // namespace tagsmith::detail
