// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/line_levels.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "decoder/image/bilinear.hpp"
#include "tagsmith/base/wide.hpp"

namespace tagsmith {
namespace {

constexpr std::size_t kBlock = 64;  // places at a time

// Where the places fall between pixels.
struct Between {
  std::array<std::int32_t, kBlock> x, y;
  std::array<double, kBlock> right, down;
};

struct Corners {
  std::array<double, kBlock> upper_left, upper_right, lower_left, lower_right;
};

// One coordinate of `count` places from place `from` on.
inline void place(double start, double direction, double spacing, int from, std::size_t count,
                  std::int32_t* __restrict pixel, double* __restrict beyond) {
  for (std::size_t i = 0; i < count; ++i) {
    const double at = start + (from + static_cast<int>(i)) * spacing * direction;
    pixel[i] = static_cast<std::int32_t>(at);
    beyond[i] = at - pixel[i];
  }
}

// All have pixels on all sides.
TAGSMITH_WIDE void sample_block(const GrayView& image, const PlacesOnLine& places, int from,
                                std::size_t count, double* __restrict levels) {
  Between at;
  Corners grey;
  place(places.start.x, places.direction.x, places.spacing, from, count, at.x.data(),
        at.right.data());
  place(places.start.y, places.direction.y, places.spacing, from, count, at.y.data(),
        at.down.data());
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* upper = image.row(at.y[i]) + at.x[i];
    const std::uint8_t* lower = upper + image.stride;
    grey.upper_left[i] = upper[0];
    grey.upper_right[i] = upper[1];
    grey.lower_left[i] = lower[0];
    grey.lower_right[i] = lower[1];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double above =
        grey.upper_left[i] + at.right[i] * (grey.upper_right[i] - grey.upper_left[i]);
    const double below =
        grey.lower_left[i] + at.right[i] * (grey.lower_right[i] - grey.lower_left[i]);
    levels[i] = above + at.down[i] * (below - above);
  }
}

}  // namespace

void sample_line(const GrayView& image, const PlacesOnLine& places, std::span<double> levels) {
  if (levels.empty()) return;
  const int last = static_cast<int>(levels.size()) - 1;
  if (!is_inside(image, places.at(0)) || !is_inside(image, places.at(last))) {
    for (int i = 0; i <= last; ++i) {
      levels[static_cast<std::size_t>(i)] = sample_bilinear(image, places.at(i));
    }
    return;
  }
  for (std::size_t i = 0; i < levels.size(); i += kBlock) {
    sample_block(image, places, places.first + static_cast<int>(i),
                 std::min(kBlock, levels.size() - i), levels.data() + i);
  }
}

}  // namespace tagsmith
