// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/text.hpp"

using namespace tagsmith::detail;

namespace {

// With so many bytes, whether or not that is allowed (RFC 3629, section 3).
std::string sequence(unsigned code, int length) {
  if (length == 1) return {static_cast<char>(code)};
  std::string bytes;
  for (int i = 1; i < length; ++i, code >>= 6U)
    bytes.insert(bytes.begin(), static_cast<char>(0x80 | (code & 0x3FU)));
  const unsigned marks = 0xF00U >> static_cast<unsigned>(length) & 0xFFU;
  return static_cast<char>(marks | code) + bytes;
}

int shortest(unsigned code) { return code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4; }

}  // namespace

TEST_CASE("each character of Unicode is one sequence, the shortest, and surrogates are none") {
  for (unsigned code = 0; code < 0x1FFFFF; code += code < 0x3000 ? 1 : 0x7F) {
    const bool is_character = code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
    for (int length = shortest(code); length <= 4; ++length) {
      const bool expected = is_character && length == shortest(code);
      const std::size_t found = utf8_length(sequence(code, length) + "a");
      if (found != (expected ? static_cast<std::size_t>(length) : 0)) FAIL(code, " in ", length);
    }
  }
  for (const unsigned last : {0xD7FFU, 0xE000U, 0xFFFFU, 0x10FFFFU}) {
    CHECK(utf8_length(sequence(last, shortest(last))) == static_cast<std::size_t>(shortest(last)));
  }
  for (const unsigned none : {0xD800U, 0xDFFFU}) CHECK(utf8_length(sequence(none, 3)) == 0);
  CHECK(utf8_length(sequence(0x110000, 4)) == 0);
}

TEST_CASE("a sequence that is cut short is none, whatever stands behind it") {
  for (const std::string whole : {"\u00c4", "\u20ac", "\U0001f512"}) {
    for (std::size_t size = 1; size < whole.size(); ++size) {
      CHECK(utf8_length(std::string_view(whole).substr(0, size)) == 0);
    }
  }
}

TEST_CASE("a page shows the first five hundred characters, whole") {
  std::string text;
  for (int i = 0; i < 501; ++i) text += "\u00c4";
  CHECK(printable_text(text) == text.substr(2));
  CHECK(printable_text("a\ufffeb\U0001ffffc") == "a b c");
}

TEST_CASE("a terminal is shown what would move its cursor, colour it or turn its text") {
  const struct {
    const char* name;
    std::string text;
    const char* shown;
  } cases[] = {
      {"plain text", "Stollen Süd °", "Stollen Süd °"},
      {"ESC, BEL, CR", "\x1b[31m\a\r", "\\x1b[31m\\x07\\x0d"},
      {"line feed and tab", "a\nok\tb", "a\\x0aok\\x09b"},
      {"NUL", std::string("a\0b", 3), "a\\x00b"},
      {"DEL", "\x7f", "\\x7f"},
      {"C1, a terminal's CSI", "\u009b31m", "\\u009b31m"},
      {"override", "\u202egpj.exe", "\\u202egpj.exe"},
      {"isolates", "\u2066a\u2069", "\\u2066a\\u2069"},
      {"marks of direction", "\u200f\u061c", "\\u200f\\u061c"},
      {"line separator", "a\u2028b", "a\\u2028b"},
      {"a byte that is no UTF-8", "a\xff", "a\\xff"},
      {"a character cut short", "\xe2\x80", "\\xe2\\x80"},
      {"an overlong form", "\xc0\x9b", "\\xc0\\x9b"},
  };
  for (const auto& one : cases) {
    CAPTURE(one.name);
    CHECK(terminal_text(one.text) == one.shown);
    CHECK(is_plain_text(one.text) == (one.text == one.shown));
    CHECK(is_plain_text(terminal_text(one.text)));
  }
  CHECK(terminal_lines("a\n\x1b\r\n") == "a\n\\x1b\\x0d\n");
}

TEST_CASE("a page gets no control characters, markup and quotes as entities") {
  CHECK(markup_text("<a href='x' title=\"y\">&</a>") ==
        "&lt;a href=&#39;x&#39; title=&quot;y&quot;&gt;&amp;&lt;/a&gt;");
  CHECK(markup_text("a\x1b\u202e\u009b\xff") == "a   \ufffd");
}

TEST_CASE("names begin with a letter or digit and have nothing that parts paths or columns") {
  for (const char* name : {"desk", "7", "Strecke \u00c4 7", "\u00c4 7", "a.b-c_d"}) {
    CAPTURE(name);
    CHECK(is_plain_name(name));
  }
  for (const char* name :
       {"", " a", "-a", ".a", "a/b", "a\\b", "a,b", "a:b", "a\"b", "a\nb", "a\u202eb", "a\xff"}) {
    CAPTURE(name);
    CHECK_FALSE(is_plain_name(name));
  }
}
