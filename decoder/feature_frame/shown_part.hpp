// SPDX-License-Identifier: Apache-2.0
// Which part of a side of a feature frame shows its edge, where something covers the rest.
#pragma once

#include <optional>
#include <vector>

#include "decoder/feature_frame/edge_samples.hpp"

namespace tagsmith::detail {

// The edge as most slices show it.
struct ShownPart {
  double place = 0;                 // pixels outwards from the side that was sampled, in its middle
  double turn = 0;                  // what is added to that at its end, and taken away at its begin
  std::vector<EdgeSample> samples;  // of the slices in which the edge lies there
};

// The straight line on which the edge lies in most slices of a side, by samples in kSlices zones
// along it; nothing where all or all but one agree, as they do on a bow too, or where fewer than
// half agree on a line. `noise`: of a sample, grey levels.
std::optional<ShownPart> shown_part(std::vector<EdgeSample> samples, double noise);

}  // namespace tagsmith::detail
