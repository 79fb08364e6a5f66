// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/shrink.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tagsmith::detail {

GrayImage shrunk_to(const GrayView& image, int most) {
  const int longer = std::max(image.width, image.height);
  const int wanted = std::max(1, (longer + most - 1) / most);
  const int square = std::clamp(wanted, 1, std::max(1, std::min(image.width, image.height)));
  const auto width = static_cast<std::size_t>(image.width / square);
  const auto area = static_cast<std::uint32_t>(square) * static_cast<std::uint32_t>(square);
  GrayImage small{image.width / square, image.height / square, {}, image.is_negative};
  small.samples.reserve(width * static_cast<std::size_t>(small.height));
  std::vector<std::uint32_t> sums(width);
  for (int row = 0; row < small.height; ++row) {
    std::ranges::fill(sums, area / 2);
    for (int y = row * square; y < (row + 1) * square; ++y) {
      const std::uint8_t* samples = image.row(y);
      for (std::size_t x = 0; x < width; ++x) {
        for (int i = 0; i < square; ++i) sums[x] += *samples++;
      }
    }
    for (const std::uint32_t sum : sums) {
      small.samples.push_back(static_cast<std::uint8_t>(sum / area));
    }
  }
  return small;
}

}  // namespace tagsmith::detail
