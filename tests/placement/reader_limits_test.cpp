// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/reader_limits.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith::detail;

TEST_CASE("a sharp tag seen squarely is read below 1 px a module, with the code book lower still") {
  const double plain = least_module_px(false, 0, 0.35);
  const double book = least_module_px(true, 0, 0.35);
  CHECK(plain > 0.1);
  CHECK(plain < 1);
  CHECK(book <= plain);
  CHECK(least_module_px(true, 0, 0.35, ReadShare::half) <= book);
}

TEST_CASE("nothing is promised beyond what was measured") {
  CHECK(std::isinf(least_module_px(true, radians(89), 0.35)));
  CHECK(std::isinf(least_module_px(true, 0, 100)));
  CHECK(least_module_px(true, 0, 0.01) == least_module_px(true, 0, 0.35));
  const BlurLimits limits(true);
  CHECK(limits.greatest_blur_px(std::cos(radians(89)), 5) < 0);
  CHECK(limits.greatest_blur_px(-0.5, 5) < 0);
  CHECK(limits.greatest_blur_px(1, limits.least_module_px() * 0.99) < 0);
}

TEST_CASE("the greatest blur is the inverse of the least resolution") {
  for (const bool book : {false, true}) {
    const BlurLimits limits(book);
    for (const double blur : {0.4, 0.8, 1.2, 1.9}) {
      CAPTURE(blur);
      const double module_px = least_module_px(book, 0, blur);
      REQUIRE(std::isfinite(module_px));
      CHECK(limits.greatest_blur_px(1, module_px + 1e-9) >= blur - 0.1);
      CHECK(limits.greatest_blur_px(1, 0.9 * module_px) <= blur);
    }
  }
}

TEST_CASE("a part of a tag takes no less than a whole one") {
  const BlurLimits parts = BlurLimits::of_parts();
  const BlurLimits whole(true);
  CHECK(parts.least_module_px() >= whole.least_module_px());
  CHECK(parts.least_module_px() < 2);
  for (const double module_px : {0.8, 1.5, 3.0}) {
    CHECK(parts.greatest_blur_px(1, module_px) <= whole.greatest_blur_px(1, module_px));
  }
  CHECK(parts.greatest_blur_px(1, 4) > 1);
  CHECK(parts.greatest_blur_px(std::cos(radians(89)), 5) < 0);
}

TEST_CASE("larger tags bear more blur, and their corners are found better") {
  const BlurLimits limits(false);
  double last = -1;
  for (double module_px = 0.3; module_px < 6; module_px *= 1.1) {
    const double blur = limits.greatest_blur_px(std::cos(radians(30)), module_px);
    CHECK(blur >= last);
    last = blur;
  }
  CHECK(corner_sigma_px(3, 0.7) < corner_sigma_px(0.5, 0.7));
  CHECK(corner_sigma_px(1, 2.8) > corner_sigma_px(1, 0.35));
  CHECK(corner_sigma_px(100, 0.1) == corner_sigma_px(50, 0.2));
}

TEST_CASE("a plate counts for less whose strokes or heights are small in the picture") {
  TagTemplate tag = test::corridor_template();
  CHECK(frame_share(tag, 1) == 1);
  CHECK(frame_share(tag, 3) == 1);  // turned about its vertical axis
  double before = 1;
  for (const double lean : {45.0, 60.0, 70.0, 75.0, 80.0}) {
    const double share = frame_share(tag, std::cos(radians(lean)));
    CHECK(share < before);
    before = share;
  }
  CHECK(frame_share(tag, std::cos(radians(75.0))) < 0.25);
  tag.frame_stroke /= 2;
  CHECK(frame_share(tag, 1) == doctest::Approx(0.58).epsilon(0.02));
  tag = test::corridor_template();
  tag.frame_inner_height /= 2;
  CHECK(frame_share(tag, 1) == doctest::Approx(0.58).epsilon(0.02));
  // Bars as low as in that frame, by wide margins.
  const double bars = bar_height(tag);
  tag = test::corridor_template();
  tag.margin_modules = (tag.frame_inner_height - bars) / 2 / module_width(tag);
  CHECK(frame_share(tag, 1) == doctest::Approx(0.58).epsilon(0.02));
  tag.margin_modules = 3;
  CHECK(frame_share(tag, 1) == 1);
}
