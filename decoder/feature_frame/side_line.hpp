// SPDX-License-Identifier: Apache-2.0
// The four sides of a feature frame's inner edge while they are being fitted.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/pixel.hpp"

namespace tagsmith {

// A side while it is being fitted.
struct SideLine {
  PixelPoint begin;
  PixelPoint end;
  PixelPoint along;    // unit, begin to end
  PixelPoint outward;  // unit
  double reach = 0;   // how far to look to both sides without leaving stroke and quiet zone, pixels
  double stroke = 0;  // likely thickness of the stroke, pixels
};

// Side i of a quadrilateral (clockwise in the image), from corner i to corner i + 1.
SideLine side_of(const Quad& quad, std::size_t i);

// A point of the side, -1 at its begin and 1 at its end.
PixelPoint point_on(const SideLine& side, double along);

// The side with its ends moved outwards by these distances, pixels.
SideLine moved(const SideLine& side, double begin_shift, double end_shift);

// Where neighbouring sides meet; nothing when they are nearly parallel or do not close.
std::optional<Quad> corners_of(const std::array<SideLine, 4>& sides);

}  // namespace tagsmith
