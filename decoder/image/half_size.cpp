// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/half_size.hpp"

#include <cstddef>
#include <cstdint>

namespace tagsmith {

GrayImage half_size(const GrayView& image) {
  GrayImage half{image.width / 2, image.height / 2, {}};
  half.samples.resize(static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
  for (int y = 0; y < half.height; ++y) {
    const std::uint8_t* upper = image.row(2 * y);
    const std::uint8_t* lower = image.row(2 * y + 1);
    std::uint8_t* target =
        half.samples.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(half.width);
    for (int x = 0; x < half.width; ++x) {
      const int sum = upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1];
      target[x] = static_cast<std::uint8_t>((sum + 2) / 4);
    }
  }
  return half;
}

}  // namespace tagsmith
