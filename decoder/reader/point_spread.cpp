// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/point_spread.hpp"

#include <algorithm>
#include <cmath>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {
namespace {

// Distance in the image between bars that are a unit apart, by which a module's width goes.
// Why: docs/decisions/0002-likelihood-decoding.md.
double width_across(const FrameHomography& image_from_frame, double u) {
  constexpr double kStep = 1e-3;
  const PixelPoint by_u = image_from_frame(u + kStep, 0.5) - image_from_frame(u - kStep, 0.5);
  const PixelPoint by_v = image_from_frame(u, 0.5 + kStep) - image_from_frame(u, 0.5 - kStep);
  return std::abs(cross(by_u, by_v)) / std::max(std::hypot(by_v.x, by_v.y), 1e-12);
}

}  // namespace

void set_spreads(const FrameHomography& image_from_frame, const SymbolLayout& layout,
                 ScanProfile& profile) {
  const double middle = width_across(image_from_frame, 0.5);
  for (ScanBin& bin : profile) {
    const double width = width_across(image_from_frame, layout.width_share(bin.at));
    bin.spread = middle / std::max(width, 1e-12);
  }
}

}  // namespace tagsmith::detail
