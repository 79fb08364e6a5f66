// SPDX-License-Identifier: Apache-2.0
// Pixel positions and the small vector arithmetic they need.
#pragma once

#include <cmath>

namespace tagsmith::detail {

// A pixel position or a difference of two; (0, 0) is the centre of the upper left pixel.
struct PixelPoint {
  double x = 0;
  double y = 0;
};

inline PixelPoint operator+(PixelPoint a, PixelPoint b) { return {a.x + b.x, a.y + b.y}; }
inline PixelPoint operator-(PixelPoint a, PixelPoint b) { return {a.x - b.x, a.y - b.y}; }
inline PixelPoint operator*(double scale, PixelPoint a) { return {scale * a.x, scale * a.y}; }
inline double dot(PixelPoint a, PixelPoint b) { return a.x * b.x + a.y * b.y; }
inline double cross(PixelPoint a, PixelPoint b) { return a.x * b.y - a.y * b.x; }
// Pixels are far from where squares overflow, so this needs no std::hypot, which is ten times as
// slow.
inline double length(PixelPoint a) { return std::sqrt(dot(a, a)); }
inline double distance(PixelPoint a, PixelPoint b) { return length(b - a); }

}  // namespace tagsmith::detail
