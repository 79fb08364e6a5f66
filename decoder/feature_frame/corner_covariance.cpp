// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/corner_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/feature_frame/tuning.hpp"

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

// The error of a side's places beyond what noise explains. Pixel locking is a wave along the side
// with one period for each pixel that it crosses: the mean of the wave moves the side, and the line
// that fits it best turns the side.
Eigen::Matrix2d unexplained(const RefinedFrame& frame, std::size_t i, double locking,
                            double displaced) {
  const PixelPoint d = frame.corners[(i + 1) % 4] - frame.corners[i];
  const double phase = std::numbers::pi * std::min(std::abs(d.x), std::abs(d.y));
  const double moved = std::hypot(locking, 2 * displaced) * std::abs(std::sph_bessel(0, phase));
  const double turned = 3 * locking * std::sph_bessel(1, phase);
  const double blurred =
      kCorner.blurred * std::pow(frame.sides[i].blur_px / frame.sides[i].stroke_px, 2);
  const double whole = std::hypot(kCorner.side + moved, blurred);
  return Eigen::Matrix2d::Constant(whole * whole) +
         Eigen::Matrix2d{{1, -1}, {-1, 1}} * turned * turned +
         Eigen::Matrix2d::Identity() * kCorner.side * kCorner.side;
}

// The covariance of the sides' places: edges are displaced alike on all sides, and more or less
// from one end of the frame to the other, as the light changes there.
CornerCovariance of_displaced_edges(const RefinedFrame& frame, double displaced, double alike) {
  Eigen::Matrix<double, 3, 8> by_mode;
  by_mode << 1, 1, 1, 1, 1, 1, 1, 1,  //
      -1, 1, 1, 1, 1, -1, -1, -1,     // along the symbol
      -1, -1, -1, 1, 1, 1, 1, -1;     // across it
  by_mode.row(0) *= std::hypot(displaced / 2, alike);
  by_mode.bottomRows<2>() *= displaced / 2;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!frame.shown[i]) by_mode.middleCols<2>(index(2 * i)).setZero();
  }
  return by_mode.transpose() * by_mode;
}

}  // namespace

double pixel_locking(const RefinedFrame& frame) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!frame.shown[i]) continue;
    sum += frame.sides[i].pixel_locking_px * frame.sides[i].pixel_locking_px;
    ++count;
  }
  return std::sqrt(sum / std::max(1.0, count));
}

CornerCovariance corner_covariance(const RefinedFrame& frame, double displaced, double alike) {
  CornerCovariance of_places = of_displaced_edges(frame, displaced, alike);
  const double locking = pixel_locking(frame);
  for (std::size_t i = 0; i < 4; ++i) {
    of_places.block<2, 2>(index(2 * i), index(2 * i)) +=
        kCorner.alike * frame.sides[i].covariance + unexplained(frame, i, locking, displaced);
  }
  const CornerCovariance by_places = corners_by_places(frame.corners);
  return by_places * of_places * by_places.transpose();
}

}  // namespace tagsmith::detail
