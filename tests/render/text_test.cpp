// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/text.hpp"

#include <algorithm>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/printable.hpp"

using namespace tagsmith;
using doctest::Approx;

namespace {

struct Box {
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
};

Box ink_of(const TextItem& item) {
  Box box;
  for (const PathSegment& segment : text_outline(item)) {
    const int count = segment.verb == PathVerb::curve ? 3 : segment.verb == PathVerb::close ? 0 : 1;
    for (int i = 0; i < count; ++i) {
      const PlatePoint& point = segment.points[static_cast<std::size_t>(i)];
      box.left = std::min(box.left, point.x);
      box.right = std::max(box.right, point.x);
      box.top = std::min(box.top, point.y);
      box.bottom = std::max(box.bottom, point.y);
    }
  }
  return box;
}

TextItem item_of(const std::string& text, double max_width = 1) {
  return {.text = text, .x = 0.1, .y = 0.2, .height = 0.008, .max_width = max_width};
}

}  // namespace

TEST_CASE("a capital letter has the height asked for and stands on its baseline") {
  const Box box = ink_of(item_of("H"));
  CHECK(box.bottom == Approx(0.2).epsilon(1e-4));
  CHECK(box.bottom - box.top == Approx(0.008).epsilon(1e-3));
  CHECK(box.left >= 0.1);
}

TEST_CASE("text too wide is shrunk to fit, text far too wide ends in an ellipsis") {
  const double natural = ink_of(item_of("HHHHHHHHHH")).right - 0.1;
  const Box shrunk = ink_of(item_of("HHHHHHHHHH", 0.8 * natural));
  CHECK(shrunk.right <= 0.1 + 0.8 * natural);
  CHECK(shrunk.bottom - shrunk.top == Approx(0.8 * 0.008).epsilon(0.05));
  const Box cut = ink_of(item_of("HHHHHHHHHH", 0.3 * natural));
  CHECK(cut.right <= 0.1 + 0.3 * natural);
  CHECK(cut.bottom - cut.top == Approx(0.6 * 0.008).epsilon(0.01));
}

TEST_CASE("centred text has its middle at x, upward text reads from below upwards") {
  TextItem item = item_of("HHHH");
  item.centred = true;
  const Box level = ink_of(item);
  CHECK((level.left + level.right) / 2 == Approx(0.1).epsilon(1e-3));
  item.upwards = true;
  const Box upright = ink_of(item);
  CHECK(upright.right == Approx(0.1).epsilon(1e-4));
  CHECK(upright.right - upright.left == Approx(0.008).epsilon(1e-3));
  CHECK((upright.top + upright.bottom) / 2 == Approx(0.2).epsilon(1e-3));
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

TEST_CASE("no text, nor text no font has, does harm") {
  CHECK(text_outline(item_of("")).empty());
  CHECK(ink_of(item_of("x", 0)).right <= 0.11);
  CHECK_FALSE(text_outline(item_of("\U000e0fff \ufffd \U0010fffd")).empty());
  CHECK(has_glyphs("corridor"));
  CHECK_FALSE(has_glyphs("\U0001e7ff"));  // unassigned
}
