// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/gray.hpp"

#include <cstdint>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/transform.hpp"
#include "tests/image/ramp.hpp"

namespace tagsmith::detail::test {
namespace {

std::vector<int> sides_of(const PixelBox& box) {
  return {box.left, box.top, box.right, box.bottom};
}

}  // namespace

TEST_CASE("the box around points holds their pixels, as far as the image has them") {
  const GrayImage image = ramp(100, 50);
  const std::vector<PixelPoint> inside{{10.2, 20.8}, {30.7, 25}};
  CHECK(sides_of(box_around(inside, 0, image.view())) == std::vector{10, 20, 32, 26});
  CHECK(sides_of(box_around(inside, 4, image.view())) == std::vector{6, 16, 36, 30});
  CHECK(sides_of(box_around(inside, 1000, image.view())) == std::vector{0, 0, 100, 50});
  const std::vector<PixelPoint> left{{-9, 10}, {-5, 20}}, below{{10, 60}, {20, 1e300}};
  CHECK(box_around(left, 2, image.view()).width() == 0);
  CHECK(box_around(below, 2, image.view()).height() == 0);
}

TEST_CASE("the extent of points is that of the longer side around them") {
  CHECK(extent_of(std::vector<PixelPoint>{{3, 8}, {10, 9}, {5, 2}}) == 7);
  CHECK(extent_of(std::vector<PixelPoint>{{3, 8}, {5, -2}}) == 10);
}

TEST_CASE("points that are no number have a box in the image") {
  const GrayImage image = ramp(100, 50);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<PixelPoint>& points :
       {std::vector<PixelPoint>{{kNone, kNone}}, std::vector<PixelPoint>{{5, kNone}, {kNone, 9}}}) {
    const PixelBox box = box_around(points, 1, image.view());
    CHECK((box.left >= 0 && box.left <= box.right && box.right <= 100));
    CHECK((box.top >= 0 && box.top <= box.bottom && box.bottom <= 50));
  }
}

TEST_CASE("a part of an image has its pixels and a copy of the part its samples") {
  const GrayImage image = ramp(40, 30);
  const GrayView part = part_of(image.view(), {7, 3, 20, 11});
  CHECK(part.width == 13);
  CHECK(part.height == 8);
  CHECK(&part.row(2)[4] == &image.view().row(5)[11]);
  const GrayImage copy = copy_of(part);
  CHECK(copy.samples.size() == 13 * 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 13; ++x) CHECK(copy.view().at(x, y) == image.view().at(7 + x, 3 + y));
  }
  GrayView negative = part;
  negative.is_negative = true;
  CHECK(copy_of(part_of(negative, {0, 0, 2, 2})).is_negative);
}

}  // namespace tagsmith::detail::test
