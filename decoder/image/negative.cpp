// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/negative.hpp"

#include <algorithm>

namespace tagsmith::detail {

GrayImage exchange_black_and_white(const GrayView& image) {
  const auto width = static_cast<std::size_t>(image.width);
  GrayImage result{image.width, image.height, {}, !image.is_negative};
  result.samples.resize(width * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    std::transform(image.row(y), image.row(y) + width,
                   result.samples.data() + width * static_cast<std::size_t>(y),
                   [](std::uint8_t sample) { return static_cast<std::uint8_t>(255 - sample); });
  }
  return result;
}

}  // namespace tagsmith::detail
