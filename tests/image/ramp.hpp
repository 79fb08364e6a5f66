// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail::test {

// A picture whose neighbouring pixels differ, with every level below 251.
inline GrayImage ramp(int width, int height) {
  GrayImage image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    image.samples.push_back(static_cast<std::uint8_t>(i * 7 % 251));
  }
  return image;
}

}  // namespace tagsmith::detail::test
