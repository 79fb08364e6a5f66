// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/side_line.hpp"

#include <algorithm>
#include <cmath>

#include "decoder/feature_frame/tuning.hpp"

namespace tagsmith::detail {

namespace {

// The frame's extent, modules, across a side that is so many times as long as the frame is deep
// there. Whether that is the height or the length follows from the proportion, unless
// foreshortening has made the frame nearly square: then the guess lies between the two.
double likely_depth(double proportion, const FrameShape& shape) {
  const double elongation = std::log(shape.length / shape.height);
  const double middle = std::sqrt(shape.length * shape.height);
  if (std::abs(elongation) < 1e-6) return middle;
  const double seen = std::log(proportion) / elongation;
  if (seen > kSide.clear_elongation) return shape.height;
  if (seen < -kSide.clear_elongation) return shape.length;
  return middle;
}

}  // namespace

// Corners are clockwise in the image, so the outside is to the left of the direction of travel.
SideLine line_through(PixelPoint begin, PixelPoint end, SideLine line) {
  line.begin = begin;
  line.end = end;
  line.along = 1.0 / std::max(distance(begin, end), 1e-9) * (end - begin);
  line.outward = {line.along.y, -line.along.x};
  return line;
}

SideLine side_of(const Quad& quad, std::size_t i, const FrameShape& shape) {
  SideLine side = line_through(quad[i], quad[(i + 1) % 4]);
  const double side_length = std::max(distance(side.begin, side.end), 1e-9);
  const PixelPoint middle = 0.5 * (side.begin + side.end);
  const PixelPoint opposite = 0.5 * (quad[(i + 2) % 4] + quad[(i + 3) % 4]);
  const double depth = std::max(std::abs(dot(middle - opposite, side.outward)), 1e-9);
  // The reach stays within stroke and quiet zone whichever way the symbol runs.
  side.reach = std::clamp(shape.stroke / std::max(shape.length, shape.height) * depth,
                          kSide.least_reach, kSide.most_reach);
  side.stroke = std::max(1.0, shape.stroke / likely_depth(side_length / depth, shape) * depth);
  return side;
}

double taper_of(const Quad& quad, const SideLine& side, std::size_t i) {
  constexpr double kStroke = 0.04;  // of the depth; of any size, the taper is nearly the same
  const Homography map =
      homography_to({quad[i], quad[(i + 1) % 4], quad[(i + 2) % 4], quad[(i + 3) % 4]});
  const double begin = dot(map(0, -kStroke) - side.begin, side.outward);
  const double end = dot(map(1, -kStroke) - side.end, side.outward);
  constexpr double kMost = 0.5;
  return std::clamp((end - begin) / std::max(end + begin, 1e-9), -kMost, kMost);
}

double SideSagitta::slope(double s) const {
  const double series_slope = c[1] + s * (2 * c[2] + s * (3 * c[3] + s * 4 * c[4]));
  return (1 - s * s) * series_slope - 2 * s * series(s);
}

SideSagittas scaled(SideSagittas bows, double by) {
  for (SideSagitta& bow : bows) {
    for (double& c : bow.c) c *= by;
  }
  return bows;
}

PixelPoint point_on(const SideLine& side, double along) {
  const PixelPoint on_chord = 0.5 * (1 - along) * side.begin + 0.5 * (1 + along) * side.end;
  if (side.bow.is_straight()) return on_chord;
  return on_chord + side.bow.at(along) * side.outward;
}

namespace {

// The side's direction at s; as long as the chord's unit or a little longer.
PixelPoint tangent(const SideLine& side, double s) {
  if (side.bow.is_straight()) return side.along;
  const double slope = side.bow.slope(s);
  return side.along + 2 * slope / distance(side.begin, side.end) * side.outward;
}

}  // namespace

SideLine moved(const SideLine& side, double begin_shift, double end_shift) {
  return line_through(side.begin + begin_shift * side.outward, side.end + end_shift * side.outward,
                      side);
}

std::optional<Quad> corners_of(const std::array<SideLine, 4>& sides) {
  Quad corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    const SideLine& before = sides[(i + 3) % 4];
    const SideLine& here = sides[i];
    // Prolonged along their tangents, from the ends, which are next to the corner.
    const PixelPoint out = tangent(before, 1);
    const PixelPoint in = tangent(here, -1);
    const double determinant = cross(out, in);
    if (std::abs(determinant) < 0.05) return std::nullopt;
    const double t = cross(here.begin - before.end, in) / determinant;
    corners[i] = before.end + t * out;
  }
  return is_convex(corners) ? std::optional(corners) : std::nullopt;
}

}  // namespace tagsmith::detail
