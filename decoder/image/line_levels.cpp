// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/line_levels.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kBlock = 64;  // places at a time

// Where places fall between pixels: the pixels before them, and how far beyond.
template <class Level>
struct Between {
  std::array<std::int32_t, kBlock> pixel;
  std::array<Level, kBlock> beyond;
};

// One coordinate of `count` places from place `from` on.
template <class Level>
inline __attribute__((always_inline)) void find_between(double start, double direction,
                                                        double spacing, int from, std::size_t count,
                                                        Between<Level>& between) {
  for (std::size_t i = 0; i < count; ++i) {
    const double at = start + (from + static_cast<int>(i)) * spacing * direction;
    between.pixel[i] = static_cast<std::int32_t>(at);
    between.beyond[i] = static_cast<Level>(at) - static_cast<Level>(between.pixel[i]);
  }
}

// All have pixels on all sides.
template <class Level>
inline __attribute__((always_inline)) void sample_block(const GrayView& image,
                                                        const PlacesOnLine& places, int from,
                                                        std::size_t count,
                                                        Level* __restrict levels) {
  Between<Level> across, down;
  std::array<std::int32_t, kBlock> upper_left, upper_right, lower_left, lower_right;
  find_between(places.start.x, places.direction.x, places.spacing, from, count, across);
  find_between(places.start.y, places.direction.y, places.spacing, from, count, down);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* upper = image.row(down.pixel[i]) + across.pixel[i];
    const std::uint8_t* lower = upper + image.stride;
    upper_left[i] = upper[0];
    upper_right[i] = upper[1];
    lower_left[i] = lower[0];
    lower_right[i] = lower[1];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Level beyond = across.beyond[i];
    const Level above = static_cast<Level>(upper_left[i]) +
                        beyond * static_cast<Level>(upper_right[i] - upper_left[i]);
    const Level below = static_cast<Level>(lower_left[i]) +
                        beyond * static_cast<Level>(lower_right[i] - lower_left[i]);
    levels[i] = above + down.beyond[i] * (below - above);
  }
}

template <class Level>
inline __attribute__((always_inline)) void sample_blocks(const GrayView& image,
                                                         const PlacesOnLine& places,
                                                         std::span<Level> levels) {
  for (std::size_t i = 0; i < levels.size(); i += kBlock) {
    sample_block(image, places, places.first + static_cast<int>(i),
                 std::min(kBlock, levels.size() - i), levels.data() + i);
  }
}

TAGSMITH_WIDE void sample_doubles(const GrayView& image, const PlacesOnLine& places,
                                  std::span<double> levels) {
  sample_blocks(image, places, levels);
}

TAGSMITH_WIDE void sample_floats(const GrayView& image, const PlacesOnLine& places,
                                 std::span<float> levels) {
  sample_blocks(image, places, levels);
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
  sample_doubles(image, places, levels);
}

void sample_line_inside(const GrayView& image, const PlacesOnLine& places,
                        std::span<float> levels) {
  sample_floats(image, places, levels);
}

}  // namespace tagsmith::detail
