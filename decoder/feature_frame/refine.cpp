// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/refine.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/normal.hpp"

namespace tagsmith {
namespace {

// A side while it is being fitted.
struct SideLine {
  PixelPoint begin;
  PixelPoint end;
  PixelPoint along;    // unit, begin to end
  PixelPoint outward;  // unit
  double reach = 0;   // how far to look to both sides without leaving stroke and quiet zone, pixels
  double stroke = 0;  // likely thickness of the stroke, pixels
};

double sample_bilinear(const GrayView& image, PixelPoint at) {
  const double x = std::clamp(at.x, 0.0, image.width - 1.001);
  const double y = std::clamp(at.y, 0.0, image.height - 1.001);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const double fx = x - x0;
  const double fy = y - y0;
  const std::uint8_t* upper = image.row(y0) + x0;
  const std::uint8_t* lower = image.row(y0 + 1) + x0;
  return (1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) +
         fy * ((1 - fx) * lower[0] + fx * lower[1]);
}

// Corners are clockwise in the image, so the outside is to the left of the direction of travel.
SideLine side_of(const Quad& quad, std::size_t i) {
  SideLine side;
  side.begin = quad[i];
  side.end = quad[(i + 1) % 4];
  side.along = 1.0 / std::max(distance(side.begin, side.end), 1e-9) * (side.end - side.begin);
  side.outward = {side.along.y, -side.along.x};
  const PixelPoint middle = 0.5 * (side.begin + side.end);
  const PixelPoint opposite = 0.5 * (quad[(i + 2) % 4] + quad[(i + 3) % 4]);
  const double depth = std::abs(dot(middle - opposite, side.outward));
  // A stroke is 4 of 113 modules across the frame's length and of 55 across its height: the reach
  // stays within stroke and quiet zone either way.
  side.reach = std::clamp(0.035 * depth, 1.5, 8.0);
  const bool along_symbol = distance(side.begin, side.end) > 1.2 * depth;
  side.stroke = std::max(1.0, (along_symbol ? 3.95 / 55.3 : 3.95 / 113) * depth);
  return side;
}

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

PixelPoint point_on(const SideLine& side, double along) {
  return 0.5 * (1 - along) * side.begin + 0.5 * (1 + along) * side.end;
}

// The side moved onto the edge that most of its profiles show; nothing when fewer than half do.
std::optional<SideLine> settle_side(const GrayView& image, const SideLine& side, double reach) {
  constexpr double kMinFall = 6;        // grey levels a pixel
  constexpr double kEnds = 0.92;        // leave the corners out
  constexpr double kLeastShown = 0.45;  // of the profiles must agree on one edge
  const double side_length = distance(side.begin, side.end);
  const int count = std::clamp(static_cast<int>(side_length / 2), 10, 40);
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

std::optional<Quad> corners_of(const std::array<SideLine, 4>& sides) {
  Quad corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    const SideLine& before = sides[(i + 3) % 4];
    const SideLine& here = sides[i];
    const double determinant = cross(before.along, here.along);
    if (std::abs(determinant) < 0.05) return std::nullopt;
    const double t = cross(here.begin - before.begin, here.along) / determinant;
    corners[i] = before.begin + t * before.along;
  }
  return is_convex(corners) ? std::optional(corners) : std::nullopt;
}

// The mean of the pixels in one place relative to a side.
struct EdgeSample {
  double along = 0;   // -1 to 1 between the side's ends
  double across = 0;  // pixels outward from the current side
  double value = 0;   // grey level
  double weight = 0;  // number of pixels
};

// Pixels near a side, gathered by how far along and how far across they lie: fine across near the
// edge, where the light changes within a pixel, coarse elsewhere.
class EdgeBins {
 public:
  EdgeBins(double inward, double outward) : inward_(inward), outward_(outward) {
    const double span = std::max(0.0, inward - kFine) + std::max(0.0, outward - kFine);
    coarse_ = std::max(0.5, span / 12);
    rows_ = index_of(outward) + 1;
    bins_.resize(kZones * rows_);
  }

  bool holds(double across) const { return across >= -inward_ && across <= outward_; }

  void add(double along, double across, double value) {
    const auto zone = static_cast<std::size_t>(
        std::clamp((along + 1) / 2 * kZones, 0.0, static_cast<double>(kZones) - 1));
    EdgeSample& bin = bins_[zone * rows_ + index_of(across)];
    bin.along += along;
    bin.across += across;
    bin.value += value;
    bin.weight += 1;
  }

  std::vector<EdgeSample> samples() const {
    std::vector<EdgeSample> samples;
    samples.reserve(bins_.size());
    for (const EdgeSample& bin : bins_) {
      if (bin.weight == 0) continue;
      samples.push_back(
          {bin.along / bin.weight, bin.across / bin.weight, bin.value / bin.weight, bin.weight});
    }
    return samples;
  }

 private:
  static constexpr std::size_t kZones = 6;
  static constexpr double kFine = 1.6;  // pixels on both sides of the edge
  static constexpr double kStep = 0.2;  // pixels

  std::size_t index_of(double across) const {
    const double fine_begin = std::max(0.0, inward_ - kFine) / coarse_;
    double position = 0;
    if (across < -kFine) {
      position = (across + inward_) / coarse_;
    } else if (across <= kFine) {
      position = std::ceil(fine_begin) + (across + kFine) / kStep;
    } else {
      position = std::ceil(fine_begin) + 2 * kFine / kStep + 1 + (across - kFine) / coarse_;
    }
    return static_cast<std::size_t>(std::max(0.0, position));
  }

  double inward_;
  double outward_;
  double coarse_ = 1;
  std::size_t rows_ = 0;
  std::vector<EdgeSample> bins_;
};

// The pixels near the side, `margin` pixels at its ends left out.
std::vector<EdgeSample> samples_near(const GrayView& image, const SideLine& side, double inward,
                                     double outward, double margin) {
  constexpr double kMaxCount = 1500;  // pixels; more add nothing that the model could use
  EdgeBins bins(inward, outward);
  const PixelPoint d = side.end - side.begin;
  const bool steep = std::abs(d.y) > std::abs(d.x);
  const double side_length = length(d);
  const double stretch = side_length / std::max(std::abs(d.x), std::abs(d.y));
  const double low = std::min(steep ? side.begin.y : side.begin.x, steep ? side.end.y : side.end.x);
  const double high =
      std::max(steep ? side.begin.y : side.begin.x, steep ? side.end.y : side.end.x);
  const double cut = margin / stretch;
  const int first = std::max(0, static_cast<int>(std::ceil(low + cut)));
  const int last =
      std::min((steep ? image.height : image.width) - 1, static_cast<int>(std::floor(high - cut)));
  const double band = std::max(inward, outward) * stretch;
  const int stride = std::max(1, static_cast<int>((last - first) * (2 * band) / kMaxCount));
  for (int major = first; major <= last; major += stride) {
    const double t = steep ? (major - side.begin.y) / d.y : (major - side.begin.x) / d.x;
    const double centre = steep ? side.begin.x + t * d.x : side.begin.y + t * d.y;
    const int limit = (steep ? image.width : image.height) - 1;
    const int from = std::max(0, static_cast<int>(std::ceil(centre - band)));
    const int to = std::min(limit, static_cast<int>(std::floor(centre + band)));
    for (int minor = from; minor <= to; ++minor) {
      const PixelPoint point{static_cast<double>(steep ? minor : major),
                             static_cast<double>(steep ? major : minor)};
      const double across = dot(point - side.begin, side.outward);
      if (!bins.holds(across)) continue;
      const double along = 2 * dot(point - side.begin, side.along) / side_length - 1;
      bins.add(along, across, steep ? image.at(minor, major) : image.at(major, minor));
    }
  }
  return bins.samples();
}

// The light across a side: white, the stroke's black, white again, blurred. Parameters: edge place
// at the middle and its slope, log blur, white and black at the middle and their slopes, log
// stroke.
constexpr int kParameters = 8;
using Parameters = Eigen::Matrix<double, kParameters, 1>;
enum : int { kPlace, kTurn, kLogBlur, kWhite, kWhiteSlope, kBlack, kBlackSlope, kLogStroke };

struct Predicted {
  double sample = 0;
  Parameters gradient = Parameters::Zero();
};

Predicted predict(const Parameters& p, const EdgeSample& at, const ToneCurve& tone) {
  const double blur = std::exp(p[kLogBlur]);
  const double stroke = std::exp(p[kLogStroke]);
  const double z_inner = (at.across - p[kPlace] - p[kTurn] * at.along) / blur;
  const double z_outer = z_inner - stroke / blur;
  const double dark = normal_integral(z_inner) - normal_integral(z_outer);
  const double white = p[kWhite] + p[kWhiteSlope] * at.along;
  const double black = p[kBlack] + p[kBlackSlope] * at.along;
  const double light = white + (black - white) * dark;
  const double slope = tone.slope_of(light);
  const double d_inner = normal_density(z_inner);
  const double d_outer = normal_density(z_outer);
  Predicted predicted;
  predicted.sample = tone.sample_of(light);
  const double by_place = slope * (black - white) * (d_outer - d_inner) / blur;
  predicted.gradient[kPlace] = by_place;
  predicted.gradient[kTurn] = by_place * at.along;
  predicted.gradient[kLogBlur] = slope * (black - white) * (z_outer * d_outer - z_inner * d_inner);
  predicted.gradient[kWhite] = slope * (1 - dark);
  predicted.gradient[kWhiteSlope] = slope * (1 - dark) * at.along;
  predicted.gradient[kBlack] = slope * dark;
  predicted.gradient[kBlackSlope] = slope * dark * at.along;
  predicted.gradient[kLogStroke] = slope * (black - white) * d_outer * stroke / blur;
  return predicted;
}

struct NormalEquations {
  Eigen::Matrix<double, kParameters, kParameters> matrix =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Parameters right = Parameters::Zero();
  double cost = 0;
  double weight = 0;
};

// Cauchy weights with the scale of the current residuals keep dirt and glare from pulling.
NormalEquations accumulate(const Parameters& p, const std::vector<EdgeSample>& samples,
                           double scale, const ToneCurve& tone) {
  NormalEquations normal;
  for (const EdgeSample& sample : samples) {
    const Predicted predicted = predict(p, sample, tone);
    const double residual = sample.value - predicted.sample;
    const double ratio = residual / scale;
    const double weight = sample.weight / (1 + ratio * ratio);
    normal.matrix.selfadjointView<Eigen::Lower>().rankUpdate(predicted.gradient, weight);
    normal.right += weight * residual * predicted.gradient;
    normal.cost += sample.weight * scale * scale * std::log1p(ratio * ratio);
    normal.weight += weight;
  }
  return normal;
}

Parameters first_guess(const std::vector<EdgeSample>& samples, const SideLine& side,
                       const ToneCurve& tone) {
  double white = 0, black = 0, whites = 0, blacks = 0;
  for (const EdgeSample& sample : samples) {
    const double light = tone.light_of(static_cast<int>(std::lround(sample.value)));
    if (sample.across < -0.4 * side.reach) {
      white += sample.weight * light;
      whites += sample.weight;
    } else if (sample.across > 0.3 * side.stroke && sample.across < 0.7 * side.stroke) {
      black += sample.weight * light;
      blacks += sample.weight;
    }
  }
  Parameters p = Parameters::Zero();
  p[kWhite] = whites > 0 ? white / whites : 0.5;
  p[kBlack] = blacks > 0 ? black / blacks : 0.05;
  p[kLogStroke] = std::log(side.stroke);
  return p;
}

// Keeps the blur, stroke and levels where the model means something.
void constrain(Parameters& p, double stroke) {
  p[kLogBlur] = std::clamp(p[kLogBlur], std::log(0.25), std::log(std::max(0.5, 0.6 * stroke)));
  p[kLogStroke] = std::clamp(p[kLogStroke], std::log(0.5 * stroke), std::log(2.0 * stroke));
  p[kWhite] = std::clamp(p[kWhite], 0.0, 1.2);
  p[kBlack] = std::clamp(p[kBlack], -0.2, 1.0);
}

// Scale of the Cauchy weights: twice the middle residual, so that noise is fitted and dirt is not.
double noise_scale(const std::vector<EdgeSample>& samples, const Parameters& p,
                   const ToneCurve& tone) {
  constexpr double kLeast = 3;  // grey levels
  std::vector<double> residuals;
  residuals.reserve(samples.size());
  for (const EdgeSample& sample : samples) {
    residuals.push_back(std::abs(sample.value - predict(p, sample, tone).sample));
  }
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return std::max(kLeast, 2 * *middle / 0.6745);
}

// The pixels that tell where a side is. A thin stroke is seen from edge to edge, of a thick one the
// inner part: then its thickness stays as guessed and does not matter.
std::vector<EdgeSample> edge_samples(const GrayView& image, const SideLine& side) {
  const double inward = std::clamp(side.stroke, 2.0, 8.0);
  const double outward = side.stroke < 4 ? side.stroke + 1.5 : std::min(0.75 * side.stroke, 8.0);
  const double margin = std::max(2.0, 1.2 * side.reach);
  return samples_near(image, side, inward, outward, margin);
}

struct Solution {
  Parameters parameters;
  NormalEquations normal;
};

// Levenberg-Marquardt with the weights' scale held; at most `max_steps` steps.
Solution minimise(const std::vector<EdgeSample>& samples, const SideLine& side, Parameters p,
                  double scale, int max_steps) {
  const ToneCurve& tone = ToneCurve::srgb();
  double damping = 1e-3;
  NormalEquations normal = accumulate(p, samples, scale, tone);
  for (int step = 0; step < max_steps && damping < 1e3; ++step) {
    Eigen::Matrix<double, kParameters, kParameters> matrix =
        normal.matrix.selfadjointView<Eigen::Lower>();
    // The constant keeps a stroke whose far edge lies outside the samples where it was.
    matrix.diagonal().array() += damping * matrix.diagonal().array() + 1e-6;
    Parameters next = p + matrix.ldlt().solve(normal.right);
    constrain(next, side.stroke);
    const NormalEquations tried = accumulate(next, samples, scale, tone);
    if (!(tried.cost < normal.cost)) {
      damping *= 10;
      continue;
    }
    const bool settled = normal.cost - tried.cost < 1e-5 * tried.cost;
    p = next;
    normal = tried;
    damping = std::max(1e-6, damping * 0.2);
    if (settled) break;
  }
  return {p, normal};
}

// First with the scale of the guess, then with that of what was found.
Solution solve_side(const std::vector<EdgeSample>& samples, const SideLine& side,
                    double start_blur) {
  const ToneCurve& tone = ToneCurve::srgb();
  Parameters p = first_guess(samples, side, tone);
  p[kLogBlur] = std::log(start_blur);
  constrain(p, side.stroke);
  p = minimise(samples, side, p, noise_scale(samples, p, tone), 6).parameters;
  return minimise(samples, side, p, noise_scale(samples, p, tone), 15);
}

SideLine moved(const SideLine& side, double begin_shift, double end_shift) {
  SideLine line = side;
  line.begin = side.begin + begin_shift * side.outward;
  line.end = side.end + end_shift * side.outward;
  line.along = 1.0 / distance(line.begin, line.end) * (line.end - line.begin);
  line.outward = {line.along.y, -line.along.x};
  return line;
}

struct SideFit {
  SideLine line;
  FrameSide side;
};

SideFit describe(const Solution& solution, const SideLine& side) {
  const Parameters& p = solution.parameters;
  SideFit fit;
  fit.line = moved(side, p[kPlace] - p[kTurn], p[kPlace] + p[kTurn]);
  fit.side.blur_px = std::exp(p[kLogBlur]);
  fit.side.stroke_px = std::exp(p[kLogStroke]);
  fit.side.white_begin = p[kWhite] - p[kWhiteSlope];
  fit.side.white_end = p[kWhite] + p[kWhiteSlope];
  fit.side.black_begin = p[kBlack] - p[kBlackSlope];
  fit.side.black_end = p[kBlack] + p[kBlackSlope];
  const double freedom = std::max(1.0, solution.normal.weight - kParameters);
  const double variance = solution.normal.cost / freedom;
  fit.side.residual = std::sqrt(variance);
  Eigen::Matrix<double, kParameters, kParameters> matrix =
      solution.normal.matrix.selfadjointView<Eigen::Lower>();
  matrix.diagonal().array() += 1e-9;
  const Parameters unit = Parameters::Unit(kPlace);
  fit.side.sigma_px = std::sqrt(std::max(0.0, variance * matrix.ldlt().solve(unit)[kPlace]));
  return fit;
}

bool stays_near(const Solution& solution, const SideLine& side) {
  const Parameters& p = solution.parameters;
  return std::abs(p[kPlace]) + std::abs(p[kTurn]) < side.reach;
}

// A side along the pixel grid shows every pixel at the same fraction, and its blur may be mistaken
// for its place: where a side's blur differs from its neighbours', theirs is tried as the start.
constexpr double kStartBlur = 0.6;  // pixels

SideFit fit_again(const GrayView& image, const SideLine& side, double start_blur,
                  const Solution& first) {
  const Solution second = solve_side(edge_samples(image, side), side, start_blur);
  const bool better =
      second.normal.cost / second.normal.weight < first.normal.cost / first.normal.weight;
  const Solution& chosen = better && stays_near(second, side) ? second : first;
  return describe(chosen, side);
}

}  // namespace

bool looks_framed(const GrayView& image, const Quad& rough) {
  constexpr int kPlaces = 8;
  constexpr int kLeastDarker = 4;
  constexpr double kLeastFall = 6;  // grey levels
  for (std::size_t i = 0; i < 4; ++i) {
    const SideLine side = side_of(rough, i);
    int darker = 0;
    for (int k = 0; k < kPlaces; ++k) {
      const PixelPoint at = point_on(side, 0.92 * (2.0 * k / (kPlaces - 1) - 1));
      const double inside = sample_bilinear(image, at + (-side.reach) * side.outward);
      const double outside = sample_bilinear(image, at + (0.7 * side.reach + 0.5) * side.outward);
      darker += inside - outside > kLeastFall ? 1 : 0;
    }
    if (darker < kLeastDarker) return false;
  }
  return true;
}

Result<Quad> settle_frame(const GrayView& image, const Quad& rough) {
  Quad quad = rough;
  for (int pass = 0; pass < 2; ++pass) {
    std::array<SideLine, 4> sides{};
    for (std::size_t i = 0; i < 4; ++i) {
      const SideLine side = side_of(quad, i);
      const auto settled = settle_side(image, side, pass == 0 ? side.reach + 1 : side.reach);
      if (!settled) return fail("feature frame: a side shows no edge along most of its length");
      sides[i] = *settled;
    }
    const std::optional<Quad> corners = corners_of(sides);
    if (!corners) return fail("feature frame: its sides do not close");
    quad = *corners;
  }
  return quad;
}

Result<RefinedFrame> refine_frame(const GrayView& image, const Quad& settled) {
  std::array<SideLine, 4> lines{};
  std::array<Solution, 4> solutions{};
  std::array<double, 4> blurs{};
  for (std::size_t i = 0; i < 4; ++i) {
    lines[i] = side_of(settled, i);
    const std::vector<EdgeSample> samples = edge_samples(image, lines[i]);
    if (samples.size() < 2 * kParameters) return fail("feature frame: a side is too short");
    solutions[i] = solve_side(samples, lines[i], kStartBlur);
    if (!stays_near(solutions[i], lines[i])) {
      return fail("feature frame: a side's edge cannot be fitted");
    }
    blurs[i] = solutions[i].parameters[kLogBlur];
  }
  std::ranges::sort(blurs);
  const double common_blur = (blurs[1] + blurs[2]) / 2;  // logarithm of
  RefinedFrame frame;
  for (std::size_t i = 0; i < 4; ++i) {
    const bool alike = std::abs(solutions[i].parameters[kLogBlur] - common_blur) < 0.25;
    const SideFit fit = alike ? describe(solutions[i], lines[i])
                              : fit_again(image, lines[i], std::exp(common_blur), solutions[i]);
    lines[i] = fit.line;
    frame.sides[i] = fit.side;
  }
  const std::optional<Quad> corners = corners_of(lines);
  if (!corners) return fail("feature frame: its sides do not close");
  frame.corners = *corners;
  return frame;
}

}  // namespace tagsmith
