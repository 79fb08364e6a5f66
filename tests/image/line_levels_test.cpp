// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/line_levels.hpp"

#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail::test {
namespace {

// The grey level between pixels in floats, at a place that is not on the last row or column.
float sample_inside(const GrayView& image, PixelPoint at) {
  const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
  const float fx = static_cast<float>(at.x) - static_cast<float>(x);
  const float fy = static_cast<float>(at.y) - static_cast<float>(y);
  const std::uint8_t* upper = image.row(y) + x;
  const std::uint8_t* lower = upper + image.stride;
  const auto level = [](std::uint8_t sample) { return static_cast<float>(sample); };
  const float above = level(upper[0]) + fx * (level(upper[1]) - level(upper[0]));
  const float below = level(lower[0]) + fx * (level(lower[1]) - level(lower[0]));
  return above + fy * (below - above);
}

}  // namespace

TEST_CASE("levels along a line are those of the places one by one, to the last bit") {
  std::mt19937 draw(7);
  GrayImage image{97, 61, std::vector<std::uint8_t>(97 * 61)};
  for (std::uint8_t& sample : image.samples) sample = static_cast<std::uint8_t>(draw());
  const GrayView view = image.view();
  struct Case {
    const char* what;
    PlacesOnLine places;
    std::size_t count;
  };
  for (const Case& line :
       {Case{"none", {{3, 3}, {1, 0}, 0, 1}, 0}, Case{"one", {{3.25, 4.5}, {1, 0}, 0, 1}, 1},
        Case{"longer than a block", {{2.1, 3.7}, {0.8, 0.6}, 0, 0.5}, 170},
        Case{"from before its start", {{40.3, 30.9}, {-0.6, 0.8}, -65, 0.25}, 150},
        Case{"along the upper border", {{0, 0}, {1, 0}, 0, 1}, 96},
        Case{"to the last pixel", {{90, 60}, {1, 0}, 0, 0.5}, 13}}) {
    CAPTURE(line.what);
    std::vector<double> levels(line.count);
    sample_line(view, line.places, levels);
    std::vector<double> one_by_one;
    for (std::size_t i = 0; i < line.count; ++i) {
      one_by_one.push_back(sample_bilinear(view, line.places.at(static_cast<int>(i))));
    }
    CHECK(levels == one_by_one);
    const auto is_apart = [&](int i) { return is_inside(view, line.places.at(i)); };
    if (line.count == 0 || !is_apart(0) || !is_apart(static_cast<int>(line.count) - 1)) continue;
    std::vector<float> rounded(line.count);
    sample_line_inside(view, line.places, rounded);
    for (std::size_t i = 0; i < line.count; ++i) {
      CHECK(rounded[i] == sample_inside(view, line.places.at(static_cast<int>(i))));
    }
  }
}

TEST_CASE("places far off or that are no numbers have levels of the image's border") {
  const GrayImage image{2, 2, {10, 20, 30, 40}};
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kFar = 1e300;
  CHECK(sample_bilinear(image.view(), {-kFar, -kFar}) == 10);
  CHECK(sample_bilinear(image.view(), {kFar, 0}) == doctest::Approx(20).epsilon(1e-3));
  CHECK(sample_bilinear(image.view(), {kNone, kNone}) == 10);
  std::vector<double> levels(3);
  sample_line(image.view(), {{kNone, 0}, {kNone, 0}}, levels);
  CHECK(levels == std::vector<double>{10, 10, 10});
}

}  // namespace tagsmith::detail::test
