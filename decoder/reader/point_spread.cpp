// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/point_spread.hpp"

#include <algorithm>
#include <cmath>

#include "decoder/image/pixel.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

// Distance in the image between bars that are a unit apart, by which a module's width goes.
double width_across(const FrameMap& image_from_unit, double u) {
  constexpr double kStep = 1e-3;
  const PixelPoint by_u = image_from_unit(u + kStep, 0.5) - image_from_unit(u - kStep, 0.5);
  const PixelPoint by_v = image_from_unit(u, 0.5 + kStep) - image_from_unit(u, 0.5 - kStep);
  return std::abs(cross(by_u, by_v)) / std::max(std::hypot(by_v.x, by_v.y), 1e-12);
}

}  // namespace

void set_spreads(const FrameMap& image_from_unit, const SymbolLayout& layout,
                 ScanProfile& profile) {
  constexpr double kMost = 4;  // a frame that is hardly one must not spread without bound
  const double quiet = layout.quiet_zone_modules;
  const double middle = width_across(image_from_unit, 0.5);
  for (ScanBin& bin : profile) {
    const double u = (bin.at + quiet) / (kModuleCount + 2 * quiet);
    bin.spread =
        std::clamp(middle / std::max(width_across(image_from_unit, u), 1e-12), 1 / kMost, kMost);
  }
}

}  // namespace tagsmith
