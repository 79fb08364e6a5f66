// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/tag/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/survey/read_template.hpp"

using namespace tagsmith::detail;
using doctest::Approx;

namespace {

// The shipped template of the paper's straight corridor or of its curved tunnel.
TagTemplate paper_template(bool large) {
  const std::string name = large ? "tag-800x430" : "tag-400x300";
  const Result<Diagnosed<TagTemplate>> reading = read_template("templates/" + name + ".yaml");
  REQUIRE(reading);
  REQUIRE(reading->value);
  CHECK(reading->diagnostics.empty());
  CHECK(reading->value->name == name);
  return *reading->value;
}

struct Dimensions {
  bool large;
  double plate_length;
  double plate_height;
  double inner_length;
  double inner_height;
  double module;  // inner length / 113, by hand
  double bar_height;
};

const Dimensions kDimensions[] = {
    {false, 0.4, 0.3, 0.343, 0.168, 0.0030353982, 0.168 - 18 * 0.0030353982},
    {true, 0.8, 0.43, 0.665, 0.325, 0.0058849558, 0.325 - 18 * 0.0058849558},
};

const Digits kDigits = *parse_digits("019000000404");

double right(const Rectangle& rectangle) { return rectangle.x + rectangle.width; }
double bottom(const Rectangle& rectangle) { return rectangle.y + rectangle.height; }

Rectangle grown(const Rectangle& rectangle, double by) {
  return {rectangle.x - by, rectangle.y - by, rectangle.width + 2 * by, rectangle.height + 2 * by};
}

bool apart(const Rectangle& a, const Rectangle& b) {
  return right(a) <= b.x || right(b) <= a.x || bottom(a) <= b.y || bottom(b) <= a.y;
}

bool contains(const Rectangle& outer, const Rectangle& inner) {
  return outer.x <= inner.x && outer.y <= inner.y && right(inner) <= right(outer) &&
         bottom(inner) <= bottom(outer);
}

// What the ink of a line that is not centred may reach.
Rectangle box_of(const TextItem& item) {
  const double thickness = (kTextAscent + kTextDescent) * item.height;
  const double before = kTextAscent * item.height;
  if (item.upwards) return {item.x - before, item.y - item.max_width, thickness, item.max_width};
  return {item.x, item.y - before, item.max_width, thickness};
}

TagText text_of(const std::string& survey) {
  return {{"000L left  0190 0000 040 4", "x 1.900 y 0.000 z 0.400 m", survey}};
}

}  // namespace

TEST_CASE("module and bar height follow from the paper's inner frame and a quiet zone of nine") {
  for (const Dimensions& expected : kDimensions) {
    const TagTemplate tag = paper_template(expected.large);
    CAPTURE(tag.name);
    CHECK(module_width(tag) == Approx(expected.module).epsilon(1e-7));
    CHECK(bar_height(tag) == Approx(expected.bar_height).epsilon(1e-7));
    CHECK(draw_tag(tag, kDigits).module == module_width(tag));
  }
}

TEST_CASE("the feature frame is centred on the plate, its upper left inner corner the origin") {
  for (const Dimensions& expected : kDimensions) {
    const TagTemplate tag = paper_template(expected.large);
    const TagDrawing drawing = draw_tag(tag, kDigits);
    CAPTURE(tag.name);
    CHECK(drawing.frame_inner.x == 0);
    CHECK(drawing.frame_inner.y == 0);
    CHECK(drawing.frame_inner.width == expected.inner_length);
    CHECK(drawing.frame_inner.height == expected.inner_height);
    CHECK(drawing.frame_outer.x == -tag.frame_stroke);
    CHECK(right(drawing.frame_outer) == Approx(tag.frame_inner_length + tag.frame_stroke));
    CHECK(-drawing.plate.x == Approx(right(drawing.plate) - tag.frame_inner_length));
    CHECK(-drawing.plate.y == Approx(bottom(drawing.plate) - tag.frame_inner_height));
    CHECK(drawing.plate.width == expected.plate_length);
    CHECK(drawing.plate.height == expected.plate_height);
  }
}

TEST_CASE("an offset moves the frame right and up on the plate") {
  TagTemplate tag = paper_template(false);
  tag.frame_offset_right = 0.01;
  tag.frame_offset_up = 0.02;
  const Rectangle plate = draw_tag(tag, kDigits).plate;
  CHECK(-plate.x == Approx((0.4 - 0.343) / 2 + 0.01));
  CHECK(-plate.y == Approx((0.3 - 0.168) / 2 - 0.02));
}

TEST_CASE("thirty bars stand on whole modules, nine clear of the frame on every side") {
  for (const Dimensions& expected : kDimensions) {
    const TagTemplate tag = paper_template(expected.large);
    const TagDrawing drawing = draw_tag(tag, kDigits);
    CAPTURE(tag.name);
    REQUIRE(drawing.bars.size() == 30);
    for (const Rectangle& bar : drawing.bars) {
      for (const double edge : {bar.x, right(bar)}) {
        const double modules = edge / drawing.module;
        CHECK(std::abs(modules - std::round(modules)) < 1e-9);
      }
      CHECK(bar.y == Approx(9 * expected.module).epsilon(1e-7));
      CHECK(bar.height == Approx(expected.bar_height).epsilon(1e-7));
    }
    CHECK(drawing.bars.front().x == Approx(9 * expected.module).epsilon(1e-7));
    CHECK(right(drawing.bars.back()) == Approx(104 * expected.module).epsilon(1e-7));
  }
}

TEST_CASE("the bars are the published modules of the digits") {
  // GS1 General Specifications' example number 012345678905 in number sets A and C.
  const std::string published =
      "101"
      "0001101"
      "0011001"
      "0010011"
      "0111101"
      "0100011"
      "0110001"
      "01010"
      "1010000"
      "1000100"
      "1001000"
      "1110100"
      "1110010"
      "1001110"
      "101";
  const TagDrawing drawing = draw_tag(paper_template(false), *parse_digits("012345678905"));
  std::string modules;
  for (int i = 0; i < 95; ++i) {
    const double middle = (9 + i + 0.5) * drawing.module;
    const bool black = std::ranges::any_of(
        drawing.bars, [&](const Rectangle& bar) { return bar.x < middle && middle < right(bar); });
    modules += black ? '1' : '0';
  }
  CHECK(modules == published);
}

TEST_CASE("the label keeps clear of the frame and inside the plate") {
  const std::string names[] = {"c", "corridor", std::string(300, 'w')};
  for (const Dimensions& expected : kDimensions) {
    for (const std::string& name : names) {
      const TagTemplate tag = paper_template(expected.large);
      const TagDrawing drawing = draw_tag(tag, kDigits, text_of(name));
      CAPTURE(tag.name);
      CAPTURE(name);
      REQUIRE_FALSE(drawing.label.empty());
      const Rectangle clear = grown(drawing.frame_outer, label_clearance(tag) - 1e-12);
      const Rectangle usable = grown(drawing.plate, -0.003 + 1e-12);
      CHECK(apart(drawing.arrows.front().box, clear));
      CHECK(contains(usable, drawing.arrows.front().box));
      for (const TextItem& item : drawing.label) {
        CHECK(item.height >= 0.005);
        CHECK(item.height <= tag.label.text_height);
        CHECK(apart(box_of(item), clear));
        CHECK(contains(usable, box_of(item)));
        CHECK(apart(box_of(item), drawing.arrows.front().box));
      }
    }
  }
}

TEST_CASE("the label's lines stand below the frame where there is room, else beside it") {
  const TagDrawing small = draw_tag(paper_template(false), kDigits, text_of("corridor"));
  REQUIRE(small.label.size() == 3);
  CHECK_FALSE(small.label[0].upwards);
  CHECK(small.label[0].y > bottom(small.frame_outer));
  TagTemplate low = paper_template(true);
  low.plate_height = low.frame_inner_height + 2 * (low.frame_stroke + label_clearance(low)) + 0.008;
  low.plate_length = low.frame_inner_length + 2 * (low.frame_stroke + label_clearance(low)) + 0.022;
  const TagDrawing large = draw_tag(low, kDigits, text_of("curved"));
  REQUIRE(large.label.size() == 1);
  CHECK(large.label[0].upwards);
  CHECK(large.label[0].x < large.frame_outer.x);
  CHECK(large.label[0].text ==
        "000L left  0190 0000 040 4  \u00b7  x 1.900 y 0.000 z 0.400 m  \u00b7  curved");
}

TEST_CASE("patches end the strip below the frame, and the label ends half a patch before them") {
  TagTemplate tag = paper_template(false);
  tag.patch_size = 0.02;
  const Rectangle strip = strip_below_frame(tag);
  const TagDrawing drawing = draw_tag(tag, kDigits, text_of("corridor"));
  REQUIRE(drawing.patches);
  const auto& [white, black] = *drawing.patches;
  CHECK(right(black) == Approx(right(strip)));
  CHECK(black.x == Approx(right(white)));
  for (const Rectangle& patch : {white, black}) {
    CHECK(patch.width == Approx(0.02));
    CHECK(patch.height == Approx(0.02));
    CHECK(patch.y - strip.y == Approx(bottom(strip) - bottom(patch)));
  }
  REQUIRE_FALSE(drawing.label.empty());
  CHECK(drawing.label[0].x + drawing.label[0].max_width == Approx(white.x - 0.01));
}

TEST_CASE("holes are drilled where the template says, and move with the plate") {
  TagTemplate tag = paper_template(false);
  tag.qr.size = 0.03;
  tag.holes = {{0.19, -0.14, 0.006}};
  const TagDrawing drawing = draw_tag(tag, kDigits);
  REQUIRE(drawing.holes.size() == 1);
  CHECK(drawing.holes[0].radius == Approx(0.003));
  CHECK(drawing.holes[0].centre.x == Approx(0.343 / 2 + 0.19));
  CHECK(drawing.holes[0].centre.y == Approx(0.168 / 2 + 0.14));
  const TagDrawing there = moved(drawing, 0.1, 0.2, 2);
  CHECK(there.holes[0].radius == Approx(0.006));
  CHECK(there.holes[0].centre.x == Approx(2 * drawing.holes[0].centre.x + 0.1));
  REQUIRE(there.qr);
  CHECK(there.qr->box.x == Approx(2 * drawing.qr->box.x + 0.1));
  CHECK(there.qr->box.y == Approx(2 * drawing.qr->box.y + 0.2));
}

TEST_CASE("patches higher than the strip below the frame, or wider than half of it, are left out") {
  const auto has_patches = [](TagTemplate tag, double size) {
    tag.patch_size = size;
    return draw_tag(tag, kDigits).patches.has_value();
  };
  TagTemplate tag = paper_template(false);
  const double height = strip_below_frame(tag).height;
  CHECK(has_patches(tag, height));
  CHECK_FALSE(has_patches(tag, height + 1e-6));
  CHECK_FALSE(has_patches(tag, 0));
  tag.plate_height = 0.6;
  const double quarter = strip_below_frame(tag).width / 4;
  CHECK(has_patches(tag, quarter - 1e-6));
  CHECK_FALSE(has_patches(tag, quarter + 1e-6));
}

TEST_CASE("a plate without room around the frame, or told not to, carries no label") {
  TagTemplate tag = paper_template(false);
  tag.plate_height = 0.168 + 4 * 0.012 + 2 * 0.003;
  tag.plate_length = 0.343 + 4 * 0.012 + 2 * 0.003;
  CHECK(draw_tag(tag, kDigits, text_of("corridor")).label.empty());
  CHECK(draw_tag(tag, kDigits, text_of("corridor")).arrows.empty());
  tag = paper_template(false);
  tag.label.shown = false;
  CHECK(draw_tag(tag, kDigits, text_of("corridor")).label.empty());
  CHECK(draw_tag(paper_template(false), kDigits).label.empty());
}

TEST_CASE("the arrow points up and fills its box") {
  const UpArrow arrow{{1, 2, 3, 4}};
  const auto corners = outline_of(arrow);
  CHECK(corners[0].x == Approx(2.5));
  CHECK(corners[0].y == Approx(2));
  for (const PlatePoint& corner : corners) {
    CHECK(corner.x >= 1);
    CHECK(corner.x <= 4);
    CHECK(corner.y >= 2);
    CHECK(corner.y <= 6);
  }
}
