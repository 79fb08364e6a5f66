// SPDX-License-Identifier: Apache-2.0
// The pixels that determine where a side of a feature frame is.
#pragma once

#include <algorithm>
#include <vector>

#include "decoder/feature_frame/side_line.hpp"
#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// Slices along a side, each of which is checked separately for covers and clipped light.
inline constexpr int kSlices = 16;

// The mean of the pixels in one place relative to a side.
struct EdgeSample {
  float along = 0;   // -1 to 1 between the side's ends
  float across = 0;  // pixels outward from the current side
  float value = 0;   // grey level
  float weight = 0;  // number of pixels
};

// Means of the pixels on both sides of the line in so many zones along it, its ends left out. A
// stroke thinner than `thin` pixels is sampled from edge to edge, of a thicker one the inner part:
// then its thickness stays as guessed and does not matter.
std::vector<EdgeSample> edge_samples(const GrayView& image, const SideLine& side,
                                     double thin = kEdgeFit.thin_stroke,
                                     int zones = kEdgeFit.zones);

// The same from so many pixels inside the edge to so many outside.
std::vector<EdgeSample> edge_samples_between(const GrayView& image, const SideLine& side,
                                             double inward, double outward,
                                             int zones = kEdgeFit.zones);

// Which of so many zones along a side a place is in.
inline int zone_at(float along, int zones) {
  return std::clamp(static_cast<int>((along + 1) * (0.5F * static_cast<float>(zones))), 0,
                    zones - 1);
}

}  // namespace tagsmith::detail
