// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/settle_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/bilinear.hpp"

namespace tagsmith {
namespace {

// Where the profile across the side falls steepest from inside to outside, as a distance from the
// side; nothing when it does not fall by `min_fall` grey levels.
std::optional<double> steepest_fall(const GrayView& image, const SideLine& side, PixelPoint at,
                                    double reach, double min_fall) {
  constexpr double kStep = 0.5;
  constexpr int kMaxSamples = 64;
  const int half = std::min(static_cast<int>(std::ceil(reach / kStep)), kMaxSamples / 2 - 2);
  std::array<double, kMaxSamples> samples{};
  const int count = 2 * half + 1;
  for (int k = 0; k < count; ++k) {
    const PixelPoint point = at + (kStep * (k - half)) * side.outward;
    samples[static_cast<std::size_t>(k)] = sample_bilinear(image, point);
  }
  const auto fall_at = [&](int k) {
    return samples[static_cast<std::size_t>(k - 1)] - samples[static_cast<std::size_t>(k + 1)];
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
    if (curvature > 0) shift = std::clamp((after - before) / (2 * curvature), -0.5, 0.5);
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

LineFit fit_line(const std::vector<EdgePoint>& points, double tolerance) {
  LineFit fit;
  // Start from the median so that a cable or a lump of dirt does not pull the first fit.
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
  int inliers = 0;
  for (const EdgePoint& point : points) {
    const double residual = point.across - fit.intercept - fit.slope * point.along;
    inliers += std::abs(residual) < tolerance ? 1 : 0;
  }
  fit.inliers = static_cast<double>(inliers) / static_cast<double>(points.size());
  return fit;
}

// The side moved onto the edge that most of its profiles show; nothing when fewer than half do.
std::optional<SideLine> settle_side(const GrayView& image, const SideLine& side, double reach) {
  constexpr double kMinFall = 6;        // grey levels a pixel
  constexpr double kEnds = 0.92;        // leave the corners out
  constexpr double kLeastShown = 0.45;  // of the profiles must agree on one edge
  const double side_length = distance(side.begin, side.end);
  const int count = std::clamp(static_cast<int>(side_length / 2), 10, 24);
  std::vector<EdgePoint> points;
  for (int k = 0; k < count; ++k) {
    const double along = kEnds * (2.0 * k / (count - 1) - 1.0);
    const auto across = steepest_fall(image, side, point_on(side, along), reach, kMinFall);
    if (across) points.push_back({along, *across});
  }
  if (static_cast<double>(points.size()) < kLeastShown * count) return std::nullopt;
  const LineFit fit = fit_line(points, 0.6);
  if (fit.inliers * static_cast<double>(points.size()) < kLeastShown * count) return std::nullopt;
  SideLine settled = side;
  settled.begin = side.begin + (fit.intercept - fit.slope) * side.outward;
  settled.end = side.end + (fit.intercept + fit.slope) * side.outward;
  settled.along = 1.0 / distance(settled.begin, settled.end) * (settled.end - settled.begin);
  settled.outward = {settled.along.y, -settled.along.x};
  return settled;
}

// Whether it is white, dark and white again from the inside of the side to its outside. The stroke
// may be half or twice as thick as guessed, because foreshortening hides which way the symbol runs.
bool crosses_stroke(const GrayView& image, const SideLine& side, PixelPoint at) {
  constexpr double kLeastFall = 6;  // grey levels
  constexpr double kLeastRise = 4;  // of those, for the plate's margin, which may be narrow
  constexpr int kSteps = 12;
  const double inside = sample_bilinear(image, at + (-side.reach) * side.outward);
  const double step = (2.5 * side.stroke + 1) / kSteps;
  double darkest = 255;
  for (int k = 0; k <= kSteps; ++k) {
    const double value = sample_bilinear(image, at + (step * k) * side.outward);
    darkest = std::min(darkest, value);
    if (inside - darkest > kLeastFall && value - darkest > kLeastRise) return true;
  }
  return false;
}

}  // namespace

bool looks_framed(const GrayView& image, const Quad& rough) {
  constexpr int kPlaces = 8;
  constexpr int kLeastAlike = 4;
  for (std::size_t i = 0; i < 4; ++i) {
    const SideLine side = side_of(rough, i);
    int alike = 0;
    for (int k = 0; k < kPlaces && alike < kLeastAlike; ++k) {
      const PixelPoint at = point_on(side, 0.92 * (2.0 * k / (kPlaces - 1) - 1));
      alike += crosses_stroke(image, side, at) ? 1 : 0;
    }
    if (alike < kLeastAlike) return false;
  }
  return true;
}

Result<Quad> settle_frame(const GrayView& image, const Quad& rough) {
  Quad quad = rough;
  for (int pass = 0; pass < 2; ++pass) {
    std::array<SideLine, 4> sides{};
    for (std::size_t i = 0; i < 4; ++i) {
      const SideLine side = side_of(quad, i);
      const auto settled =
          settle_side(image, side, pass == 0 ? side.reach + 1 : std::min(side.reach, 3.0));
      if (!settled) return fail("feature frame: a side shows no edge along most of its length");
      sides[i] = *settled;
    }
    const std::optional<Quad> corners = corners_of(sides);
    if (!corners) return fail("feature frame: its sides do not close");
    quad = *corners;
  }
  return quad;
}

std::optional<ShownSides> settle_shown_sides(const GrayView& image, const Quad& rough) {
  ShownSides result{rough, {}};
  for (int pass = 0; pass < 2; ++pass) {
    std::array<SideLine, 4> sides{};
    for (std::size_t i = 0; i < 4; ++i) {
      sides[i] = side_of(result.quad, i);
      const double reach = pass == 0 ? sides[i].reach + 1 : std::min(sides[i].reach, 3.0);
      const auto settled = settle_side(image, sides[i], reach);
      result.shown[i] = settled.has_value();
      if (settled) sides[i] = *settled;
    }
    const std::optional<Quad> corners = corners_of(sides);
    if (!corners) return std::nullopt;
    result.quad = *corners;
  }
  return result;
}

}  // namespace tagsmith
