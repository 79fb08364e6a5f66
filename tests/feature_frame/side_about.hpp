// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "decoder/feature_frame/side_line.hpp"

namespace tagsmith::detail::test {

// A straight side about a place, so many pixels long, at an angle (radians, clockwise on the screen
// from rightwards), with a stroke of so many pixels on its left; looked at 3 pixels to both sides.
inline SideLine side_about(PixelPoint middle, double angle, double length, double stroke) {
  SideLine side;
  side.along = {std::cos(angle), std::sin(angle)};
  side.outward = {side.along.y, -side.along.x};
  side.begin = middle - length / 2 * side.along;
  side.end = middle + length / 2 * side.along;
  side.reach = 3;
  side.stroke = stroke;
  return side;
}

}  // namespace tagsmith::detail::test
