// SPDX-License-Identifier: Apache-2.0
#include <random>

#include <doctest/doctest.h>

#include "decoder/feature_frame/bar_regions.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::SeenTag;

namespace {

constexpr int kImageWidth = 100, kImageHeight = 60;

template <class LevelAt>
GrayImage image_of(const LevelAt& level_at) {
  GrayImage image{kImageWidth, kImageHeight, {}};
  for (int y = 0; y < kImageHeight; ++y) {
    for (int x = 0; x < kImageWidth; ++x) {
      image.samples.push_back(static_cast<std::uint8_t>(level_at(x, y)));
    }
  }
  return image;
}

}  // namespace

TEST_CASE("on a ramp the steps are its slope by the distance between places") {
  const GrayImage ramp = image_of([](int x, int y) { return x + 2 * y; });
  // 80 places over 0.76 of the quadrilateral.
  const double x_step = 0.76 * 80 / 79, y_step = 0.76 * 40 / 79;
  const BarSteps upright = bar_steps(ramp.view(), {{{10, 10}, {90, 10}, {90, 50}, {10, 50}}});
  CHECK(upright.along == doctest::Approx(x_step).epsilon(1e-6));
  CHECK(upright.across == doctest::Approx(2 * y_step).epsilon(1e-6));
  const BarSteps turned = bar_steps(ramp.view(), {{{90, 10}, {90, 50}, {10, 50}, {10, 10}}});
  CHECK(turned.along == doctest::Approx(2 * y_step).epsilon(1e-6));
  CHECK(turned.across == doctest::Approx(x_step).epsilon(1e-6));
}

TEST_CASE("what does not run through the quadrilateral counts less than what does") {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> level(60, 200);
  const Quad quad{{{4, 4}, {95, 4}, {95, 55}, {4, 55}}};
  std::array<int, kImageWidth> columns{};
  for (int& column : columns) column = level(random);
  const GrayImage lines =
      image_of([&](int x, int) { return columns[static_cast<std::size_t>(x)]; });
  const GrayImage noise = image_of([&](int, int) { return level(random); });
  const BarSteps of_lines = bar_steps(lines.view(), quad);
  const BarSteps of_noise = bar_steps(noise.view(), quad);
  CHECK(of_lines.along > 10);
  CHECK(of_lines.across == 0);
  // The mean of six independent rows varies by 1 / sqrt(6) as much.
  CHECK(of_noise.along < of_lines.along / 2);
  CHECK(of_noise.along > of_lines.along / 4);
}

TEST_CASE("bars run across the longer way of the symbol however it is turned and slanted") {
  SeenTag tag;
  tag.width = tag.height = 340;
  tag.view = {{170, 170}, 2.2, 0, {0.002, -0.001}};
  for (const double turn : {0.0, 0.7, 1.9, 3.3}) {
    CAPTURE(turn);
    tag.view.turn = turn;
    const GrayImage image = tag.image();
    const Quad c = tag.corners();
    const BarSteps steps = bar_steps(image.view(), c);
    CHECK(steps.along > 10 * steps.across);
    const BarSteps from_next = bar_steps(image.view(), {c[1], c[2], c[3], c[0]});
    CHECK(from_next.across > 10 * from_next.along);
  }
}
