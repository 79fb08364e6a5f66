// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/coarse_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/line_levels.hpp"

namespace tagsmith::detail {
namespace {

// Where the profile across the side falls steepest from inside to outside, as a distance from the
// side; nothing when it does not fall by `min_fall` grey levels.
std::optional<double> steepest_fall(const GrayView& image, const SideLine& side, PixelPoint at,
                                    double reach, double min_fall) {
  constexpr double kStep = 0.5;
  constexpr int kMaxSamples = 64;
  const int half = std::min(static_cast<int>(std::ceil(reach / kStep)), kMaxSamples / 2 - 2);
  std::array<double, kMaxSamples> samples;
  const int count = 2 * half + 1;
  sample_line(image, {at, side.outward, -half, kStep},
              std::span(samples).first(static_cast<std::size_t>(count)));
  const auto fall_at = [&](int k) {
    const auto at_k = static_cast<std::size_t>(k);
    return samples[at_k - 1] - samples[at_k + 1];
  };
  int best = -1;
  double fall = min_fall;
  for (int k = 1; k + 1 < count; ++k) {
    if (fall_at(k) <= fall) continue;
    fall = fall_at(k);
    best = k;
  }
  if (best < 0) return std::nullopt;
  double shift = 0;
  if (best >= 2 && best + 2 < count) {
    const double before = fall_at(best - 1);
    const double after = fall_at(best + 1);
    const double curvature = 2 * fall - before - after;
    if (curvature > 0) shift = (after - before) / (2 * curvature);
  }
  return kStep * (best - half + shift);
}

struct EdgePoint {
  double along = 0;   // -1 at the side's begin, 1 at its end
  double across = 0;  // pixels outward
};

// across = intercept + slope * along, by iteratively reweighted least squares.
struct LineFit {
  double intercept = 0;
  double slope = 0;
  double inliers = 0;  // fraction of the points within the tolerance
};

double share_within(const std::vector<EdgePoint>& points, double tolerance, const auto& curve) {
  const auto inliers = std::ranges::count_if(points, [&](const EdgePoint& point) {
    return std::abs(point.across - curve(point.along)) < tolerance;
  });
  return static_cast<double>(inliers) / static_cast<double>(points.size());
}

LineFit fit_line(const std::vector<EdgePoint>& points, double tolerance) {
  LineFit fit;
  // Starts from the median so that a cable or a lump of dirt does not affect the first fit.
  std::vector<double> sorted;
  for (const EdgePoint& point : points) sorted.push_back(point.across);
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  fit.intercept = sorted[sorted.size() / 2];
  for (int iteration = 0; iteration < 8; ++iteration) {
    const double width = std::max(tolerance, tolerance * (6 - iteration));
    double sw = 0, st = 0, stt = 0, sa = 0, sta = 0;
    for (const EdgePoint& point : points) {
      const double residual = point.across - fit.intercept - fit.slope * point.along;
      const double ratio = residual / (2 * width);
      const double weight = std::abs(ratio) < 1 ? (1 - ratio * ratio) * (1 - ratio * ratio) : 0;
      sw += weight;
      st += weight * point.along;
      stt += weight * point.along * point.along;
      sa += weight * point.across;
      sta += weight * point.along * point.across;
    }
    const double determinant = sw * stt - st * st;
    if (determinant < 1e-9) break;
    fit.intercept = (stt * sa - st * sta) / determinant;
    fit.slope = (sw * sta - st * sa) / determinant;
  }
  fit.inliers = share_within(points, tolerance,
                             [&](double along) { return fit.intercept + fit.slope * along; });
  return fit;
}

// across = line + bow * (1 - along^2).
struct BowedFit {
  LineFit line;
  double bow = 0;
};

BowedFit fit_bowed(const std::vector<EdgePoint>& points, double tolerance) {
  constexpr int kIterations = 10;
  Eigen::Vector3d fit = Eigen::Vector3d::Zero();
  const auto at = [&](double along) {
    return fit[0] + along * fit[1] + (1 - along * along) * fit[2];
  };
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const double width = tolerance * std::max(1, kIterations - 2 - iteration);
    Eigen::Matrix3d matrix = 1e-3 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const EdgePoint& point : points) {
      const double ratio = (point.across - at(point.along)) / (2 * width);
      // The first time all count, because there is no fit yet.
      const double weight = iteration == 0        ? 1
                            : std::abs(ratio) < 1 ? std::pow(1 - ratio * ratio, 2)
                                                  : 0;
      const Eigen::Vector3d terms(1, point.along, 1 - point.along * point.along);
      matrix += weight * terms * terms.transpose();
      right += weight * point.across * terms;
    }
    fit = matrix.ldlt().solve(right);
  }
  return {{fit[0], fit[1], share_within(points, tolerance, at)}, fit[2]};
}

// The line, or the bowed side where more of the points agree with that.
BowedFit fit_side(const std::vector<EdgePoint>& points, bool may_bow) {
  const LineFit line = fit_line(points, kSide.tolerance);
  if (!may_bow || line.inliers > kSide.agreed) return {line, 0};
  const BowedFit bowed = fit_bowed(points, kSide.tolerance);
  return bowed.line.inliers > line.inliers ? bowed : BowedFit{line, 0};
}

// The side moved onto the edge that most of its profiles show; nothing when fewer than half do.
std::optional<SideLine> settle_side(const GrayView& image, const SideLine& side, double reach,
                                    bool may_bow) {
  const double side_length = distance(side.begin, side.end);
  const int count = std::clamp(static_cast<int>(side_length / 2), 10, 24);
  std::vector<EdgePoint> points;
  for (int k = 0; k < count; ++k) {
    const double along = kSide.scanned * (2.0 * k / (count - 1) - 1.0);
    const auto across = steepest_fall(image, side, point_on(side, along), reach, kSide.least_fall);
    if (across) points.push_back({along, *across});
  }
  if (static_cast<double>(points.size()) < kSide.least_shown * count) return std::nullopt;
  const auto [fit, bow] = fit_side(points, may_bow);
  if (fit.inliers * static_cast<double>(points.size()) < kSide.least_shown * count)
    return std::nullopt;
  SideLine settled = moved(side, fit.intercept - fit.slope, fit.intercept + fit.slope);
  settled.bow.c[0] += bow;
  return settled;
}

// Whether it is white, dark and white again from the inside of the side to its outside. The stroke
// may be half or twice as thick as guessed, because foreshortening hides which way the symbol runs.
// Where the picture's border cuts the stroke, white and dark are enough; an outline within
// the tolerance of the border shows no stroke.
bool crosses_stroke(const GrayView& image, const SideLine& side, PixelPoint at) {
  constexpr int kSteps = 12;
  const double inside = sample_bilinear(image, at + (-side.reach) * side.outward);
  const double step = (2.5 * side.stroke + 1) / kSteps;
  const auto place = [&](int k) { return at + (step * k) * side.outward; };
  const bool ends_in_image = is_inside(image, place(kSteps));
  const bool in_image = ends_in_image && is_inside(image, place(0));
  double darkest = 255;
  for (int k = 0; k <= kSteps; ++k) {
    const double value = in_image ? interpolate(image, place(k)) : sample_bilinear(image, place(k));
    darkest = std::min(darkest, value);
    if (std::min(inside, value) - darkest > kSide.least_fall) return true;
  }
  const bool is_cut = !ends_in_image && is_inside(image, at + kSide.tolerance * side.outward);
  return is_cut && inside - darkest > kSide.least_fall;
}

}  // namespace

bool looks_framed(const GrayView& image, const Quad& rough, const FrameShape& shape,
                  const std::array<bool, 4>& looked_at) {
  constexpr int kPlaces = 8;
  constexpr int kLeastAlike = 4;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!looked_at[i]) continue;
    const SideLine side = side_of(rough, i, shape);
    int alike = 0;
    for (int k = 0; k < kPlaces && alike < kLeastAlike; ++k) {
      const PixelPoint at = point_on(side, kSide.scanned * (2.0 * k / (kPlaces - 1) - 1));
      alike += crosses_stroke(image, side, at) ? 1 : 0;
    }
    if (alike < kLeastAlike) return false;
  }
  return true;
}

FrameResult<CoarseFrame> fit_frame_coarsely(const GrayView& image, const Quad& rough,
                                            const SideSagittas& bows, const FrameShape& shape) {
  CoarseFrame frame{rough, bows};
  for (int pass = 0; pass < 2; ++pass) {
    std::array<SideLine, 4> sides{};
    for (std::size_t i = 0; i < 4; ++i) {
      SideLine side = side_of(frame.corners, i, shape);
      side.bow = frame.bows[i];
      const double reach = pass == 0 ? side.reach + 1 : std::min(side.reach, 3.0);
      const auto settled = settle_side(image, side, reach, true);
      if (!settled) return fail(FrameFault::no_edge);
      sides[i] = *settled;
      frame.bows[i] = settled->bow;
    }
    const std::optional<Quad> corners = corners_of(sides);
    if (!corners) return fail(FrameFault::not_closed);
    frame.corners = *corners;
  }
  return frame;
}

std::optional<ShownSides> settle_shown_sides(const GrayView& image, const Quad& rough,
                                             const SideSagittas& bows, const FrameShape& shape) {
  ShownSides result{rough, {}};
  for (int pass = 0; pass < 2; ++pass) {
    std::array<SideLine, 4> sides{};
    for (std::size_t i = 0; i < 4; ++i) {
      sides[i] = side_of(result.quad, i, shape);
      sides[i].bow = bows[i];
      const double reach = pass == 0 ? sides[i].reach + 1 : std::min(sides[i].reach, 3.0);
      const auto settled = settle_side(image, sides[i], reach, false);
      result.shown[i] = settled.has_value();
      if (settled) sides[i] = *settled;
    }
    const std::optional<Quad> corners = corners_of(sides);
    if (!corners) return std::nullopt;
    result.quad = *corners;
  }
  return result;
}

}  // namespace tagsmith::detail
