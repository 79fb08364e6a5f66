// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/corner_covariance.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/side_line.hpp"

namespace tagsmith::detail {
namespace {

constexpr Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i % 8); }

// Corners by places: columns 2 i and 2 i + 1 are side i's place at its begin (corner i) and at its
// end (corner i + 1).
CornerCovariance corners_by_places(const Quad& corners) {
  CornerCovariance by_places = CornerCovariance::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t before = (i + 3) % 4;
    const PixelPoint first = side_of(corners, before).outward;
    const PixelPoint second = side_of(corners, i).outward;
    Eigen::Matrix2d normals;
    normals << first.x, first.y, second.x, second.y;
    const Eigen::Matrix2d by_sides = normals.inverse();
    by_places.block<2, 1>(index(2 * i), index(2 * before + 1)) = by_sides.col(0);
    by_places.block<2, 1>(index(2 * i), index(2 * i)) = by_sides.col(1);
  }
  return by_places;
}

// What a side's places are off by beyond what noise explains. The sizes are those seen on the
// ray-traced photos of docs/accuracy.md.
// Why: docs/decisions/0007-corner-covariance.md.
Eigen::Matrix2d unexplained(const RefinedFrame& frame, std::size_t i) {
  constexpr double kEnd = 0.005;    // pixels, either end by itself
  constexpr double kWhole = 0.006;  // the side as a whole
  // A pixel's response is no Gaussian, so an edge is found a little off, depending on where in the
  // pixel it lies. A side that crosses pixels averages that; one along the pixel grid does not.
  constexpr double kAlongGrid = 0.015;
  // Where the blur reaches from one edge of the stroke to the other, the model's errors do too.
  constexpr double kBlurred = 0.5;
  const PixelPoint d = frame.corners[(i + 1) % 4] - frame.corners[i];
  const double crossed = std::min(std::abs(d.x), std::abs(d.y));
  const double along_grid = kAlongGrid * std::max(0.0, 1 - crossed);
  const double blurred = kBlurred * std::pow(frame.sides[i].blur_px / frame.sides[i].stroke_px, 2);
  const double whole = std::hypot(kWhole + along_grid, blurred);
  return Eigen::Matrix2d::Constant(whole * whole) + Eigen::Matrix2d::Identity() * kEnd * kEnd;
}

}  // namespace

CornerCovariance corner_covariance(const RefinedFrame& frame) {
  constexpr double kJpeg = 1.8;  // compression makes neighbouring pixels' noise alike
  CornerCovariance of_places = CornerCovariance::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    of_places.block<2, 2>(index(2 * i), index(2 * i)) =
        kJpeg * frame.sides[i].covariance + unexplained(frame, i);
  }
  const CornerCovariance by_places = corners_by_places(frame.corners);
  return by_places * of_places * by_places.transpose();
}

CornerCovariance turned(const CornerCovariance& covariance, std::size_t first) {
  CornerCovariance result;
  for (std::size_t row = 0; row < 8; ++row) {
    for (std::size_t column = 0; column < 8; ++column) {
      result(index(row), index(column)) =
          covariance(index(row + 2 * first), index(column + 2 * first));
    }
  }
  return result;
}

}  // namespace tagsmith::detail
