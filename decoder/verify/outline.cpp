// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/outline.hpp"

#include <cstddef>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/pixel.hpp"

namespace tagsmith {
namespace {

// True when the point lies inside the corners' convex outline, whichever way it turns.
bool lies_in(const FrameCorners& corners, const PixelPoint& point) {
  int left = 0;
  int right = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const PixelPoint& a = corners[i];
    const PixelPoint& b = corners[(i + 1) % corners.size()];
    ++(cross(b - a, point - a) < 0 ? left : right);
  }
  return left == 0 || right == 0;
}

}  // namespace

bool overlap(const FrameCorners& a, const FrameCorners& b) {
  return lies_in(a, centre_of(b)) || lies_in(b, centre_of(a));
}

}  // namespace tagsmith
