// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/text.hpp"

#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"

using namespace tagsmith::detail;

TEST_CASE("one letter too many, too few or another is a slip of the pen") {
  const std::vector<std::string> words{"mount_height", "plate_height", "spacing"};
  for (const char* slip : {"spacin", "spacingg", "spaching", "sparing", "pacing"}) {
    CAPTURE(slip);
    CHECK(nearest_word(slip, words) == "spacing");
  }
  CHECK(nearest_word("mount_heigth", words) == "mount_height");
  CHECK(nearest_word("plateheight", words) == "plate_height");
  CHECK_FALSE(nearest_word("heading", words));
  CHECK_FALSE(nearest_word("", words));
}

TEST_CASE("a third of a word's letters may be slips, of a short word one") {
  const std::vector<std::string> words{"abcdef", "xy"};
  CHECK(nearest_word("a__def", words) == "abcdef");
  CHECK_FALSE(nearest_word("a___ef", words));
  for (const char* slip : {"x_", "x", "y", "xyz", "zxy"}) {
    CAPTURE(slip);
    CHECK(nearest_word(slip, words) == "xy");
  }
  CHECK_FALSE(nearest_word("__", words));
}

TEST_CASE("numbers are read whole, as any country writes them in files") {
  for (const char* text : {"1.5", "+1.5", "15e-1"}) CHECK(parse_number(text) == 1.5);
  for (const char* text : {"", "+", "1,5", "1.5 m", "0x10", "inf", "nan", "1e999", " 1"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_number(text));
  }
  CHECK(parse_integer("-2147483648") == -2147483647 - 1);
  for (const char* text : {"2147483648", "1.0", "", "7 "}) CHECK_FALSE(parse_integer(text));
}

TEST_CASE("letters change their case, words come apart, quotes are doubled within quotes") {
  CHECK(lower_case("A4 \u00c9") == "a4 \u00c9");
  CHECK(upper_case("tl 000l") == "TL 000L");
  CHECK(split_words(" 1.5\t-2\r\n3 ") == std::vector<std::string>{"1.5", "-2", "3"});
  CHECK(split_words(" \n").empty());
  CHECK(single_quoted("a 'b' c") == "'a ''b'' c'");
}

TEST_CASE("a shell takes a quoted word for one") {
  CHECK(shell_word("drift-7/survey.yaml") == "drift-7/survey.yaml");
  CHECK(shell_word("drift 7") == "'drift 7'");
  CHECK(shell_word("it's") == "'it'\\''s'");
}

TEST_CASE("one thing is counted without an s") {
  CHECK(counted(0, "file") == "0 files");
  CHECK(counted(1, "position tag") == "1 position tag");
  CHECK(counted(2, "file") == "2 files");
}

TEST_CASE("zeros that say nothing are not written") {
  CHECK(format_number(1.5) == "1.5");
  CHECK(format_number(300, 0) == "300");
  CHECK(format_number(300) == "300");
  CHECK(format_number(-0.0000001) == "0");
  CHECK(mm_text(0.343) == "343");
  CHECK(mm_text(0.0002644) == "0.264");
}

// RFC 4648, section 10.
TEST_CASE("base64 gives the vectors of its standard") {
  const struct {
    const char* bytes;
    const char* text;
  } cases[] = {{"", ""},
               {"f", "Zg=="},
               {"fo", "Zm8="},
               {"foo", "Zm9v"},
               {"foob", "Zm9vYg=="},
               {"fooba", "Zm9vYmE="},
               {"foobar", "Zm9vYmFy"}};
  for (const auto& one : cases) CHECK(base64(one.bytes) == one.text);
  CHECK(base64("\xfb\xef\xff") == "++//");
}

TEST_CASE("a stream's lines come one by one, the last without its end too") {
  std::istringstream stream("first\n\nlast");
  CHECK(read_line(stream, 100) == "first");
  CHECK(read_line(stream, 100) == "");
  CHECK(read_line(stream, 100) == "last");
  CHECK_FALSE(read_line(stream, 100));
}
