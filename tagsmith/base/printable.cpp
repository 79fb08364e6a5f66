// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/printable.hpp"

#include <cctype>

#include <fmt/format.h>

namespace tagsmith::detail {
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

}  // namespace tagsmith::detail
