// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/page.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "tests/render/sample_survey.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

Rectangle box_of(const PageLine& line) {
  return {std::min(line.from.x, line.to.x), std::min(line.from.y, line.to.y),
          std::abs(line.to.x - line.from.x), std::abs(line.to.y - line.from.y)};
}

bool overlap(const Rectangle& a, const Rectangle& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

}  // namespace

TEST_CASE("the page is the plate with 25 mm around it") {
  const Page page = sample_page(small_template());
  CHECK(page.width == Approx(0.45));
  CHECK(page.height == Approx(0.35));
  CHECK(page.tags[0].drawing.plate.x == Approx(0.025));
  CHECK(page.tags[0].drawing.plate.y == Approx(0.025));
}

TEST_CASE("a wider margin widens the page, a plate shorter than a scale bar too") {
  const Survey survey = sample_survey(small_template());
  const PlacedTag tag = sample_tag(survey, {1, 2, 0.5});
  CHECK(tag_page(survey, tag, {.margin = 0.05}).width == Approx(0.5));
  TagTemplate tiny = small_template();
  tiny.plate_length = 0.08;
  tiny.plate_height = 0.06;
  tiny.frame_inner_length = 0.06;
  tiny.frame_inner_height = 0.03;
  tiny.frame_stroke = 0.003;
  const Page page = sample_page(tiny);
  CHECK(page.width == Approx(0.15));
  CHECK(page.height == Approx(0.15));
}

TEST_CASE("crop marks and scale bars stay on the page and off the plate") {
  for (const TagTemplate& tag : {small_template(), large_template()}) {
    const Page page = sample_page(tag);
    for (const PageLine& line : page.lines) {
      const Rectangle box = box_of(line);
      CHECK(box.x >= 0.005);
      CHECK(box.y >= 0.005);
      CHECK(box.x + box.width <= page.width - 0.005);
      CHECK(box.y + box.height <= page.height - 0.005);
      CHECK_FALSE(overlap({box.x - 1e-4, box.y - 1e-4, box.width + 2e-4, box.height + 2e-4},
                          page.tags[0].drawing.plate));
    }
  }
}

TEST_CASE("two crop marks a corner are in line with the plate's edges") {
  const Page page = sample_page(small_template());
  const Rectangle& plate = page.tags[0].drawing.plate;
  for (const double x : {plate.x, plate.x + plate.width}) {
    const auto marks = std::ranges::count_if(page.lines, [&](const PageLine& line) {
      return std::abs(line.from.x - x) < 1e-12 && std::abs(line.to.x - x) < 1e-12;
    });
    CHECK(marks == 2);
  }
}

TEST_CASE("the label says name, side, digits by axis, coordinates and survey") {
  const Survey survey = sample_survey(small_template(), CheckDigit::sum10);
  const PlacedTag tag = sample_tag(survey, {1.9, 0.343, 0.4});
  const TagText text = tag_text(survey, tag);
  REQUIRE(text.lines.size() == 3);
  CHECK(text.lines[0] == "000L left  \u00b7  0190 0034 040 1");
  CHECK(text.lines[1] == "chainage 0.000 m  \u00b7  x 1.900  y 0.343  z 0.400 m");
  CHECK(text.lines[2] == "corridor");
}

TEST_CASE("digits are grouped as the survey's code has them") {
  PositionCode code;
  code.digit_counts = {3, 5, 3};
  CHECK(grouped_digits(code, *parse_digits("123456789012")) == "123 45678 901 2");
}

TEST_CASE("the margin says what the page is and what to measure") {
  const Page page = sample_page(small_template());
  std::string all;
  for (const TextItem& item : page.texts) all += item.text + "\n";
  for (const char* part : {"corridor 000L", "tag-400x300", "343 \u00d7 168 mm", "400 \u00d7 300 mm",
                           "print at 100 %"}) {
    CAPTURE(part);
    CHECK(all.find(part) != std::string::npos);
  }
  const auto lengths =
      std::ranges::count_if(page.texts, [](const TextItem& item) { return item.text == "100 mm"; });
  CHECK(lengths == 2);
}
