// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/placed_corners.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/feature_frame/tuning.hpp"
#include "decoder/reader/robust_profile.hpp"
#include "decoder/scan/symbol_fit.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

using CornerVector = Eigen::Matrix<double, 8, 1>;

PlacedCorners placed_by_frame(const SymbolHypothesis& symbol) {
  const double by_growth = growth_of(symbol).doubt_px / 2;
  const double by_shadows = symbol.in_shadow ? kCorner.in_shadow : 0;
  return {corners_of(symbol), corner_covariance(symbol.frame, std::hypot(by_growth, by_shadows))};
}

CornerVector as_vector(const FrameCorners& corners) {
  CornerVector vector;
  for (std::size_t i = 0; i < 4; ++i) {
    vector.segment<2>(static_cast<Eigen::Index>(2 * i)) << corners[i].x, corners[i].y;
  }
  return vector;
}

// How far outwards the bars see four places on the sides, pixels, beyond the frame as it was
// fitted: on side 3 and on side 1 in the upper half of their height, and the same in the lower
// half.
struct SeenOutwards {
  Eigen::Vector4d by_bars;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  // By how much these places move outwards with the corners.
  Eigen::Matrix<double, 4, 8> by_corners = Eigen::Matrix<double, 4, 8>::Zero();
};

// Enters how a place moves outwards with the corners: that of side 3 or 1 at a height, a share of
// the frame's. Returns how far it lies outwards for a displacement of the bars.
Eigen::RowVector3d enter_place(Eigen::Index place, std::size_t side, double height,
                               const SymbolHypothesis& symbol, SeenOutwards& seen) {
  const SymbolLayout& layout = symbol.layout;
  const FrameHomography map(symbol.frame.corners, symbol.frame.lens);
  const auto seen_at = [&](double module) { return map(layout.width_share(module), height); };
  const double quiet = layout.quiet_zone_modules;
  const double module = side == 3 ? -quiet : kModuleCount + quiet;
  const SideLine line = side_of(symbol.frame.corners, side);
  const double share =
      dot(seen_at(module) - line.begin, line.along) / distance(line.begin, line.end);
  const Eigen::RowVector2d outward{line.outward.x, line.outward.y};
  const auto begin = static_cast<Eigen::Index>(2 * side);
  const auto end = static_cast<Eigen::Index>(2 * ((side + 1) % 4));
  seen.by_corners.block<1, 2>(place, begin) = (1 - share) * outward;
  seen.by_corners.block<1, 2>(place, end) = share * outward;
  const double module_px = dot(seen_at(module + 0.5) - seen_at(module - 0.5), line.outward);
  return module_px * SeenPlaces::by_displacement(module);
}

// Enters the two places that the bars of half their height see.
void enter_half(const HeightShare& half, Eigen::Index first, const SymbolHypothesis& symbol,
                const RobustProfile& rows, SeenOutwards& seen) {
  const SeenPlaces bars = seen_places(rows.of_agreeing_rows(half).bins, symbol.decoding.digits,
                                      symbol.decoding.fit.image);
  const double height = middle_height(half, symbol.layout);
  Eigen::Matrix<double, 2, 3> by_displacement;
  by_displacement << enter_place(first, 3, height, symbol, seen),
      enter_place(first + 1, 1, height, symbol, seen);
  seen.by_bars.segment<2>(first) = by_displacement * bars.displacement;
  const double alike = kCorner.alike * (symbol.frame.was_sharpened ? bars.correlation : 1);
  seen.covariance.block<2, 2>(first, first) =
      alike * by_displacement * bars.covariance * by_displacement.transpose();
}

// Variance of sides by the bars, pixels^2, by what is not known of a lens. A lens of the division
// model moves what is t along the bars from their middle by lambda t^3 and by terms that shift,
// stretch and bend take up. One that is not quite of its model moves along a frame twice as long as
// high up to twice what it bows the longer sides.
double lens_variance(const SymbolHypothesis& symbol) {
  const RefinedFrame& frame = symbol.frame;
  const double half_length = symbol.profile.module_px * kModuleCount / 2;
  const double unseen = frame.lens_doubt * std::pow(half_length, 3);
  double bow = 0;
  for (const SideSagitta& side : sagittas_of(frame.lens, frame.corners)) {
    bow = std::max(bow, std::abs(side.middle()));
  }
  const double shape = 2 * kLens.shape * bow;
  return unseen * unseen + shape * shape;
}

// Bars are off by what a frame's sides are off by beyond what noise explains, each side as a whole
// and both its halves by themselves, and these by the lens.
void add_unexplained(const SymbolHypothesis& symbol, SeenOutwards& seen) {
  const double alone = kCorner.end * kCorner.end + lens_variance(symbol);
  for (Eigen::Index i = 0; i < 4; ++i) {
    for (Eigen::Index j = i % 2; j < 4; j += 2) {
      seen.covariance(i, j) += kCorner.whole * kCorner.whole;
    }
    seen.covariance(i, i) += alone;
  }
}

}  // namespace

// Least squares of the corners by the frame and of the places by the bars.
PlacedCorners placed_by_frame_and_bars(const GrayView& image, const SymbolHypothesis& symbol) {
  const PlacedCorners by_frame = placed_by_frame(symbol);
  const RobustProfile rows(image, symbol.frame, symbol.layout, symbol.profile.is_evened);
  SeenOutwards seen;
  enter_half({0, 0.5}, 0, symbol, rows, seen);
  enter_half({0.5, 1}, 2, symbol, rows, seen);
  add_unexplained(symbol, seen);
  const CornerVector at = as_vector(by_frame.corners);
  const auto off = (seen.by_bars - seen.by_corners * (at - as_vector(symbol.frame.corners))).eval();
  const auto shared = (by_frame.covariance * seen.by_corners.transpose()).eval();
  const auto solver = (seen.by_corners * shared + seen.covariance).eval().ldlt();
  const double contradiction = off.dot(solver.solve(off));
  if (!(contradiction < kCorner.most_contradiction)) return by_frame;
  const CornerVector placed = at + shared * solver.solve(off);
  PlacedCorners both{{}, by_frame.covariance - shared * solver.solve(shared.transpose())};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto k = static_cast<Eigen::Index>(2 * i);
    both.corners[i] = {placed[k], placed[k + 1]};
  }
  return both;
}

}  // namespace tagsmith::detail
