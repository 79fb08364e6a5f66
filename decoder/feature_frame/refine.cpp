// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/refine.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/feature_frame/edge_samples.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/normal.hpp"

namespace tagsmith {
namespace {

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
  const NormalTable& normal = NormalTable::get();
  const NormalValue inner = normal(static_cast<float>(z_inner));
  const NormalValue outer = normal(static_cast<float>(z_outer));
  const auto dark = static_cast<double>(inner.integral - outer.integral);
  const double white = p[kWhite] + p[kWhiteSlope] * at.along;
  const double black = p[kBlack] + p[kBlackSlope] * at.along;
  const double light = white + (black - white) * dark;
  const double slope = tone.slope_of(light);
  const auto d_inner = static_cast<double>(inner.density);
  const auto d_outer = static_cast<double>(outer.density);
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
                           const SideLine& side, double scale, const ToneCurve& tone) {
  NormalEquations normal;
  // The stroke is about as thick as guessed; where its far edge is out of sight, that is all there
  // is.
  constexpr double kStrokeSigma = 0.6;  // of the logarithm
  const double stroke_weight = scale * scale / (kStrokeSigma * kStrokeSigma);
  const double stroke_residual = std::log(side.stroke) - p[kLogStroke];
  normal.matrix(kLogStroke, kLogStroke) = stroke_weight;
  normal.right[kLogStroke] = stroke_weight * stroke_residual;
  normal.cost = stroke_weight * stroke_residual * stroke_residual;
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

struct Solution {
  Parameters parameters;
  NormalEquations normal;
};

// Levenberg-Marquardt with the weights' scale held; at most `max_steps` steps.
Solution minimise(const std::vector<EdgeSample>& samples, const SideLine& side, Parameters p,
                  double scale, int max_steps) {
  const ToneCurve& tone = ToneCurve::srgb();
  double damping = 1e-3;
  NormalEquations normal = accumulate(p, samples, side, scale, tone);
  for (int step = 0; step < max_steps && damping < 1e3; ++step) {
    Eigen::Matrix<double, kParameters, kParameters> matrix =
        normal.matrix.selfadjointView<Eigen::Lower>();
    matrix.diagonal() *= 1 + damping;
    Parameters next = p + matrix.ldlt().solve(normal.right);
    constrain(next, side.stroke);
    const NormalEquations tried = accumulate(next, samples, side, scale, tone);
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
  return fit;
}

bool stays_near(const Solution& solution, const SideLine& side) {
  const Parameters& p = solution.parameters;
  return std::abs(p[kPlace]) + std::abs(p[kTurn]) < side.reach;
}

// A side along the pixel grid shows every pixel at the same fraction, and its blur may be mistaken
// for its place: where a side's blur differs from its neighbours', theirs is tried as the start.
constexpr double kStartBlur = 0.6;  // pixels

SideFit fit_again(const std::vector<EdgeSample>& samples, const SideLine& side, double start_blur,
                  const Solution& first) {
  const Solution second = solve_side(samples, side, start_blur);
  const bool better =
      second.normal.cost / second.normal.weight < first.normal.cost / first.normal.weight;
  const Solution& chosen = better && stays_near(second, side) ? second : first;
  return describe(chosen, side);
}

}  // namespace

Result<RefinedFrame> refine_frame(const GrayView& image, const Quad& settled) {
  std::array<SideLine, 4> lines{};
  std::array<std::vector<EdgeSample>, 4> samples;
  std::array<Solution, 4> solutions{};
  std::array<double, 4> blurs{};
  for (std::size_t i = 0; i < 4; ++i) {
    lines[i] = side_of(settled, i);
    samples[i] = edge_samples(image, lines[i]);
    if (samples[i].size() < 2 * kParameters) return fail("feature frame: a side is too short");
    solutions[i] = solve_side(samples[i], lines[i], kStartBlur);
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
    const SideFit fit = alike
                            ? describe(solutions[i], lines[i])
                            : fit_again(samples[i], lines[i], std::exp(common_blur), solutions[i]);
    lines[i] = fit.line;
    frame.sides[i] = fit.side;
  }
  const std::optional<Quad> corners = corners_of(lines);
  if (!corners) return fail("feature frame: its sides do not close");
  frame.corners = *corners;
  return frame;
}

}  // namespace tagsmith
