// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/printable.hpp"

#include <string>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

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
