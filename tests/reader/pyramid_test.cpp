// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <random>

#include <doctest/doctest.h>

#include "decoder/feature_frame/tile_threshold.hpp"
#include "decoder/reader/searched_image.hpp"

using namespace tagsmith::detail;

namespace {

GrayImage noise_of(int width, int height) {
  std::mt19937 random(11);
  GrayImage image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    image.samples.push_back(static_cast<std::uint8_t>(random() % 256));
  }
  return image;
}

// Mean of the samples of the full image under a pixel of a level.
double mean_under(const GrayImage& image, int scale, int x, int y) {
  double sum = 0;
  for (int dy = 0; dy < scale; ++dy) {
    for (int dx = 0; dx < scale; ++dx) sum += image.view().at(x * scale + dx, y * scale + dy);
  }
  return sum / (scale * scale);
}

}  // namespace

TEST_CASE("levels halve from the full image down to one that is small, the coarsest first") {
  const GrayImage image = noise_of(1301, 1403);
  const Pyramid pyramid(image.view());
  // The next one would be less than 160 pixels wide.
  const std::vector<int> widths{162, 325, 650, 1301}, heights{175, 350, 701, 1403};
  REQUIRE(pyramid.levels().size() == widths.size());
  for (std::size_t i = 0; i < widths.size(); ++i) {
    CAPTURE(i);
    const SearchLevel& at = pyramid.levels()[i];
    CHECK(at.level.image.width == widths[i]);
    CHECK(at.level.image.height == heights[i]);
    CHECK(at.level.scale == 8 >> i);
    CHECK(at.texture.columns == (widths[i] + kTile - 1) / kTile);
    CHECK(at.texture.rows == (heights[i] + kTile - 1) / kTile);
    for (int k = 0; k < 50; ++k) {
      const int x = k * 37 % widths[i], y = k * 53 % heights[i];
      const double mean = mean_under(image, static_cast<int>(at.level.scale), x, y);
      CHECK(std::abs(at.level.image.at(x, y) - mean) <= 1.6);  // rounded at every level
    }
  }
  CHECK(pyramid.levels().back().level.image.data == image.samples.data());
  CHECK(pyramid.scaled_down(2).level.scale == 2);
  CHECK(pyramid.scaled_down(4).level.scale == 4);
}

TEST_CASE("coarser levels take less contrast for an edge, as their noise is less") {
  const GrayImage image = noise_of(700, 700);
  const Pyramid pyramid(image.view());
  for (std::size_t i = 1; i < pyramid.levels().size(); ++i) {
    CHECK(pyramid.levels()[i - 1].level.min_contrast < pyramid.levels()[i].level.min_contrast);
  }
}

TEST_CASE("a small image has a half and a quarter of it all the same") {
  const GrayImage image = noise_of(90, 41);
  const Pyramid pyramid(image.view());
  REQUIRE(pyramid.levels().size() == 3);
  CHECK(pyramid.scaled_down(4).level.image.width == 22);
  CHECK(pyramid.scaled_down(2).level.image.height == 20);
}
