// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "decoder/image/gray.hpp"
#include "decoder/image/pixel.hpp"

namespace tagsmith::detail {

// The grey level of the nearest pixel; nothing beyond the centres of the outermost ones, and for a
// place that is no number.
inline std::optional<std::uint8_t> sample_nearest(const GrayView& image, PixelPoint at) {
  const bool inside = at.x >= 0 && at.y >= 0 && at.x <= image.width - 1 && at.y <= image.height - 1;
  if (!inside) return std::nullopt;
  return image.at(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y)));
}

}  // namespace tagsmith::detail
