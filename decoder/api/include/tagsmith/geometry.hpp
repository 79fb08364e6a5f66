// SPDX-License-Identifier: Apache-2.0
// Points, matrices and poses as plain values.
//
// Grid: the mine's coordinates x, y, z, metres, as the survey has them. Vehicle: origin O, x
// forward, y left, z up. Camera: x right, y down, z along the optical axis. Pixels: (0, 0) is the
// centre of the upper left pixel, x to the right, y down. Angles are radians.
#pragma once

#include <array>
#include <cstddef>

namespace tagsmith {

// A place in an image, pixels.
struct Point {
  double x = 0;
  double y = 0;
};

using Vector3 = std::array<double, 3>;

// Rows of a square matrix.
template <std::size_t N>
using Matrix = std::array<std::array<double, N>, N>;

// The inner corners of a tag's feature frame in an image, clockwise from P as the tag's own "up"
// says: P, F, lower right, Q.
using Corners = std::array<Point, 4>;

// Of the corners' coordinates, in the order P.x, P.y, F.x, F.y, ...; pixels squared.
using CornerCovariance = Matrix<8>;

}  // namespace tagsmith
