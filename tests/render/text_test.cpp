// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/text.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/text.hpp"

using namespace tagsmith::detail;
using doctest::Approx;

namespace {

struct Box {
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
};

// Where the text is inked, metres from its place.
Box ink_of(const SheetText& text) {
  Box box;
  std::string path = text_path(text);
  for (char& c : path) c = std::isalpha(static_cast<unsigned char>(c)) ? ' ' : c;
  std::istringstream numbers(path);
  for (double x = 0, y = 0; numbers >> x >> y;) {
    box.left = std::min(box.left, x / 1000);
    box.right = std::max(box.right, x / 1000);
    box.top = std::min(box.top, y / 1000);
    box.bottom = std::max(box.bottom, y / 1000);
  }
  return box;
}

SheetText text_of(const std::string& text, double max_width = 1) {
  return {.text = text, .height = 0.008, .max_width = max_width};
}

}  // namespace

TEST_CASE("a capital letter has the height asked for and stands on its baseline") {
  const Box box = ink_of(text_of("H"));
  CHECK(std::abs(box.bottom) < 2e-5);
  CHECK(box.bottom - box.top == Approx(0.008).epsilon(1e-3));
  CHECK(box.left >= 0);
}

TEST_CASE("text is as long as was said, but for the room beside its first and last letter") {
  const Box box = ink_of(text_of("HHHHHHHHHH"));
  const double width = text_width("HHHHHHHHHH", 0.008);
  CHECK(box.right - box.left <= width);
  CHECK(box.right - box.left > 0.95 * width);
}

TEST_CASE("text too wide is shrunk to fit, text far too wide ends in an ellipsis") {
  const double natural = ink_of(text_of("HHHHHHHHHH")).right;
  const Box shrunk = ink_of(text_of("HHHHHHHHHH", 0.8 * natural));
  CHECK(shrunk.right <= 0.8 * natural);
  CHECK(shrunk.bottom - shrunk.top == Approx(0.8 * 0.008).epsilon(0.05));
  const Box cut = ink_of(text_of("HHHHHHHHHH", 0.3 * natural));
  CHECK(cut.right <= 0.3 * natural);
  CHECK(cut.bottom - cut.top == Approx(0.6 * 0.008).epsilon(0.01));
}

TEST_CASE("centred text has its middle at its place") {
  SheetText text = text_of("HHHH");
  text.centred = true;
  const Box box = ink_of(text);
  CHECK(std::abs(box.left + box.right) < 2e-5);
}

TEST_CASE("a text is broken at its spaces into lines that fit, whole words alone") {
  const std::string text = "one two three incomprehensibilities four";
  const double width = text_width("one two", 0.002) * 1.01;
  CHECK(lines_of(text, width, 0.002) ==
        std::vector<std::string>{"one two", "three", "incomprehensibilities", "four"});
  CHECK(lines_of("", width, 0.002).empty());
}

TEST_CASE("any bytes become printable text") {
  CHECK(printable_text("Stollen \u00c4") == "Stollen \u00c4");
  CHECK(printable_text("a\nb\tc\x7f"
                       "d") == "a b c d");
  CHECK(printable_text("\xff\xfe") == "\ufffd\ufffd");
  CHECK(printable_text("") == "");
  CHECK(printable_text(std::string(100000, 'x')).size() == 500);
  CHECK(printable_text(std::string("a\0b", 3)).size() > 0);
}

TEST_CASE("groups of digits and signs keep their order beside words from right to left") {
  const std::string word = "\u05D9\u05DE\u05D9\u05DF";  // Hebrew: right
  // Outlines come from left to right. A line that begins with such a word is read from the right.
  const std::string digits = text_path(text_of("000R - 1150 1122 6"));
  CHECK(text_path(text_of(word + " 000R - 1150 1122 6")).starts_with(digits));
  CHECK(text_path(text_of(word + " -409.000")).starts_with(text_path(text_of("-409.000"))));
  const std::string name = text_path(text_of("000R"));
  CHECK(text_path(text_of("000R " + word + " 1150 6")).starts_with(name));
  // Parts that a middle dot joins stay one after the other.
  const std::string first = "000R " + word + " 1150";
  CHECK(text_path(text_of(first + " \u00B7 6.5 " + word)).starts_with(text_path(text_of(first))));
}

TEST_CASE("no text, nor text no font has, does harm") {
  CHECK(text_path(text_of("")).empty());
  CHECK(ink_of(text_of("x", 0)).right <= 0.01);
  CHECK_FALSE(text_path(text_of("\U000e0fff \ufffd \U0010fffd")).empty());
  CHECK(has_glyphs("corridor"));
  CHECK_FALSE(has_glyphs("\U0001e7ff"));  // unassigned
}
