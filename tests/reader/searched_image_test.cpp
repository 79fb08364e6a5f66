// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/searched_image.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "decoder/feature_frame/tile_threshold.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::SeenTag;

namespace {

SeenTag bare_symbol(const test::PlaneView& view) {
  SeenTag tag;
  tag.framed = false;
  tag.view = view;
  return tag;
}

// A white picture with symbols on it.
GrayImage picture_of(int width, int height, const std::vector<SeenTag>& symbols) {
  constexpr int kReach = 280;
  GrayImage picture{width, height, {}};
  picture.samples.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 230);
  for (const SeenTag& symbol : symbols) {
    SeenTag part = symbol;
    const int left = std::max(0, static_cast<int>(symbol.view.middle.x) - kReach);
    const int top = std::max(0, static_cast<int>(symbol.view.middle.y) - kReach);
    part.view.middle = symbol.view.middle - PixelPoint{1.0 * left, 1.0 * top};
    part.width = std::min(2 * kReach, width - left);
    part.height = std::min(2 * kReach, height - top);
    const GrayImage drawn = part.image();
    for (int y = 0; y < part.height; ++y) {
      for (int x = 0; x < part.width; ++x) {
        auto& sample = picture.samples[static_cast<std::size_t>((top + y) * width + left + x)];
        sample = std::min(sample, drawn.view().at(x, y));
      }
    }
  }
  return picture;
}

// To a tile of the image at a quarter of its size, at each end.
void check_is(const BarRegion& found, const BarRegion& expected) {
  constexpr double kTiles = 2 * 4 * kTile;
  CHECK(distance(found.centre, expected.centre) < 0.06 * expected.length);
  CHECK(std::abs(dot(found.across, expected.across)) > 0.99);
  CHECK(std::abs(found.length - expected.length) < 1.2 * kTiles);
  CHECK(std::abs(found.height - expected.height) < 1.2 * kTiles);
}

}  // namespace

TEST_CASE("each symbol is one region, the largest first, in pixels of the full image") {
  const SeenTag large = bare_symbol({{330, 420}, 5, 0.5, {}});
  const SeenTag small = bare_symbol({{800, 200}, 1.8, -0.2, {}});
  const GrayImage image = picture_of(1100, 800, {small, large});
  SearchedImage picture(image.view());
  CHECK(picture.image().data == image.samples.data());
  const std::vector<BarRegion>& bars = picture.bars();
  REQUIRE(bars.size() == 2);
  check_is(bars[0], large.region());
  check_is(bars[1], small.region());
}

TEST_CASE("what is shared is made once") {
  GrayImage image = picture_of(400, 300, {bare_symbol({{200, 150}, 1.5, 0, {}})});
  SearchedImage picture(image.view());
  const auto* const levels = &picture.pyramid().levels();
  REQUIRE(picture.bars().size() == 1);
  image.samples.assign(image.samples.size(), 230);
  CHECK(&picture.pyramid().levels() == levels);
  CHECK(picture.bars().size() == 1);
  CHECK(SearchedImage(image.view()).bars().empty());
}

TEST_CASE("the full level of a large image is not looked at") {
  const SeenTag fine = bare_symbol({{300, 300}, 0.5, 0, {}});
  const GrayImage small = picture_of(900, 700, {fine}), large = picture_of(2100, 1000, {fine});
  CHECK(SearchedImage(small.view()).bars().size() == 1);
  CHECK(SearchedImage(large.view()).bars().empty());
}
