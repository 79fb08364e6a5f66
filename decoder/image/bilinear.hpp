// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "decoder/image/gray.hpp"
#include "decoder/image/pixel.hpp"

namespace tagsmith::detail {

// Whether a place has pixels on all sides.
inline bool is_inside(const GrayView& image, PixelPoint at) {
  return at.x >= 0 && at.y >= 0 && at.x <= image.width - 1.001 && at.y <= image.height - 1.001;
}

// The grey level between pixels at a place inside the image.
inline double interpolate(const GrayView& image, PixelPoint at) {
  const int x0 = static_cast<int>(at.x);
  const int y0 = static_cast<int>(at.y);
  const double fx = at.x - x0;
  const double fy = at.y - y0;
  const std::uint8_t* upper = image.row(y0) + x0;
  const std::uint8_t* lower = upper + image.stride;
  const double above = upper[0] + fx * (upper[1] - upper[0]);
  const double below = lower[0] + fx * (lower[1] - lower[0]);
  return above + fy * (below - above);
}

// The grey level between pixels; beyond the image that of its border. A coordinate that is no
// number counts as 0.
inline double sample_bilinear(const GrayView& image, PixelPoint at) {
  return interpolate(image, {at.x > 0 ? std::min(at.x, image.width - 1.001) : 0.0,
                             at.y > 0 ? std::min(at.y, image.height - 1.001) : 0.0});
}

}  // namespace tagsmith::detail
