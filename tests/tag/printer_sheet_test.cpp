// SPDX-License-Identifier: Apache-2.0
// A scan is measured by where the sheet has things now: sheets that are printed already must agree.
#include <doctest/doctest.h>

#include "tagsmith/tag/printer_test.hpp"

using namespace tagsmith::detail;
using doctest::Approx;

TEST_CASE("the printer's test sheet is the one that was printed before") {
  const PrinterTest test = printer_test();
  REQUIRE(test.codes.size() == 4);
  REQUIRE(test.marks.size() == 4);
  // 3 (7 + 0 + 1 + 5 + 2 + n) + (7 + 3 + 9 + 8 + 6) is 81 with n = 1, 90 with n = 4.
  CHECK(to_string(test.codes.front()) == "770319582619");
  CHECK(to_string(test.codes.back()) == "770319582640");
  CHECK(test.marks.front().frame_outer.x == Approx(0));
  CHECK(test.marks.front().frame_inner.y == Approx(0.003));
  CHECK(test.marks.back().frame_inner.x == Approx(0.120));
  CHECK(test.marks.back().frame_inner.y == Approx(0.223));
  REQUIRE(test.upright.size() == 8);
  CHECK(test.upright.front().width == Approx(0.00025));
  CHECK(test.upright.back().x == Approx(0.109 - 0.0015));
  CHECK(test.upright.back().width == Approx(0.003));
  REQUIRE(test.lying.size() == 8);
  CHECK(test.lying.back().y == Approx(0.122 - 0.0015));
  CHECK(test.lying.back().height == Approx(0.003));
  REQUIRE(test.tones.size() == 11);
  CHECK(test.tones.back().square.x == Approx(0.148));
  CHECK(test.tones.back().cover == 1);
  CHECK(test.scales[0].width == Approx(0.150));
  CHECK(test.scales[1].height == Approx(0.150));
}
