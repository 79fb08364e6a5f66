// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/field_displacement.hpp"

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail::test {
namespace {

// Blurred stripes of several widths that lean by so many columns a row, with noise; what the odd
// rows show is displaced by so many pixels.
GrayImage stripes(double lean, double displacement, double noise) {
  constexpr int kWidth = 240, kHeight = 90;
  std::mt19937 draw(5);
  std::normal_distribution<double> error(0, noise);
  GrayImage image{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight)};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double at = x + lean * y + (y % 2) * displacement;
      const double level =
          120 + 50 * std::sin(at / 2.1) + 30 * std::sin(at / 3.7) + 20 * std::sin(at / 11);
      image.samples[static_cast<std::size_t>(y * kWidth + x)] =
          static_cast<std::uint8_t>(level + error(draw));
    }
  }
  return image;
}

}  // namespace

TEST_CASE("the displacement of two fields of a picture is measured") {
  for (const double lean : {0.0, 0.2, -0.4}) {
    for (const double displacement : {0.2, -0.6, 1.0, 2.7, -6.5}) {
      CAPTURE(lean);
      CAPTURE(displacement);
      const GrayImage image = stripes(lean, displacement, 3);
      CHECK(field_displacement(image.view()) ==
            doctest::Approx(std::abs(displacement)).epsilon(0.15));
    }
  }
}

TEST_CASE("rows of a single exposure have no fields") {
  for (const double lean : {0.0, 0.2, 1.0}) {
    for (const double noise : {0.0, 3.0, 20.0}) {
      CAPTURE(lean);
      CAPTURE(noise);
      CHECK(field_displacement(stripes(lean, 0, noise).view()) == 0);
    }
  }
}

TEST_CASE("rows that show nothing have no fields") {
  const GrayImage plain{240, 90, std::vector<std::uint8_t>(240 * 90, 200)};
  CHECK(field_displacement(plain.view()) == 0);
}

TEST_CASE("an image of few rows or columns has no fields") {
  const GrayImage image = stripes(0, 2, 0);
  for (const int width : {0, 1, 15, 16, 17}) {
    CAPTURE(width);
    const double displacement = field_displacement(part_of(image.view(), {0, 0, width, 90}));
    CHECK(displacement >= 0);
    if (width <= 2 * kMostFieldDisplacement) CHECK(displacement == 0);
  }
  for (const int height : {0, 1, 3, 6}) {
    CHECK(field_displacement(part_of(image.view(), {0, 0, 240, height})) == 0);
  }
}

}  // namespace tagsmith::detail::test
