// SPDX-License-Identifier: Apache-2.0
// The four sides of a feature frame's inner edge while they are being fitted.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// How far a side stands outwards from the chord between its ends where a lens bends it:
// (1 - s^2) (c0 + c1 s + c2 s^2 + ...) pixels at s, which is -1 at the begin and 1 at the end.
struct SideSagitta {
  std::array<double, 5> c{};

  double middle() const { return c[0]; }
  bool is_straight() const { return c == std::array<double, 5>{}; }
  double at(double s) const { return (1 - s * s) * series(s); }
  double slope(double s) const;  // of at, by s

 private:
  double series(double s) const { return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4]))); }
};

using SideSagittas = std::array<SideSagitta, 4>;

// The bows in an image this many times as large.
SideSagittas scaled(SideSagittas bows, double by);

// A side while it is being fitted.
struct SideLine {
  PixelPoint begin;
  PixelPoint end;
  PixelPoint along;    // unit, begin to end
  PixelPoint outward;  // unit
  double reach = 0;   // how far to look to both sides without leaving stroke and quiet zone, pixels
  double stroke = 0;  // likely thickness of the stroke, pixels
  double taper = 0;   // by which share the stroke is thicker at the end than amid the side
  SideSagitta bow;
};

// Side i of a quadrilateral (clockwise in the image), from corner i to corner i + 1; straight. How
// far to look and how thick the stroke is likely to be follow from the frame's shape.
SideLine side_of(const Quad& quad, std::size_t i, const FrameShape& shape = {});

// The side through two points; otherwise as another one.
SideLine line_through(PixelPoint begin, PixelPoint end, SideLine other = {});

// The taper of a side's stroke when the quadrilateral is a rectangle seen in perspective.
double taper_of(const Quad& quad, const SideLine& side, std::size_t i);

// A point of the side, -1 at its begin and 1 at its end.
PixelPoint point_on(const SideLine& side, double along);

// The side with its ends moved outwards by these distances, pixels.
SideLine moved(const SideLine& side, double begin_shift, double end_shift);

// Where neighbouring sides meet; nothing when they are nearly parallel or do not close.
std::optional<Quad> corners_of(const std::array<SideLine, 4>& sides);

}  // namespace tagsmith::detail
