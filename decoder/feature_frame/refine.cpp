// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/refine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/feature_frame/edge_samples.hpp"
#include "decoder/feature_frame/shown_part.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/correlation.hpp"
#include "tagsmith/base/normal.hpp"
#include "tagsmith/base/quantile.hpp"
#include "tagsmith/geometry/damped_steps.hpp"

namespace tagsmith::detail {
namespace {

// Four samples at a time.
using Four = Eigen::Array4f;

// The light across a side: white, the stroke's black, white again, blurred. Parameters: edge place
// at the middle and its slope, log blur, white and black at the middle and their slopes, log
// stroke.
constexpr int kParameters = 8;
constexpr std::size_t kLeastSamples = 2 * std::size_t{kParameters};  // of a side
using Parameters = Eigen::Matrix<double, kParameters, 1>;
enum : int { kPlace, kTurn, kLogBlur, kWhite, kWhiteSlope, kBlack, kBlackSlope, kLogStroke };

// The parameters as they enter every sample.
struct StepModel {
  StepModel(const Parameters& p, const SideLine& side, const ToneCurve& of_image)
      : tone(of_image),
        place(static_cast<float>(p[kPlace])),
        turn(static_cast<float>(p[kTurn])),
        per_blur(static_cast<float>(std::exp(-p[kLogBlur]))),
        stroke(static_cast<float>(std::exp(p[kLogStroke]))),
        white(static_cast<float>(p[kWhite])),
        white_slope(static_cast<float>(p[kWhiteSlope])),
        black(static_cast<float>(p[kBlack])),
        black_slope(static_cast<float>(p[kBlackSlope])),
        taper(static_cast<float>(side.taper)) {}

  Four stroke_at(const Four& along) const { return stroke * (1 + taper * along); }

  const ToneCurve& tone;
  float place, turn, per_blur, stroke, white, white_slope, black, black_slope, taper;
};

// Four samples; places beyond a side's last sample have weight zero.
struct FourSamples {
  Four along = Four::Zero();
  Four across = Four::Zero();
  Four value = Four::Zero();
  Four weight = Four::Zero();
};

// The samples of a side.
struct SideSamples {
  SideSamples(const GrayView& image, std::vector<EdgeSample> of_side)
      : tone(ToneCurve::of(image)), samples(std::move(of_side)), fours((samples.size() + 3) / 4) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto lane = static_cast<Eigen::Index>(i % 4);
      FourSamples& four = fours[i / 4];
      four.along[lane] = samples[i].along;
      four.across[lane] = samples[i].across;
      four.value[lane] = samples[i].value;
      four.weight[lane] = samples[i].weight;
    }
  }

  const ToneCurve& tone;
  std::vector<EdgeSample> samples;
  std::vector<FourSamples> fours;  // the same
};

// The samples' prediction and what it depends on.
struct Predicted {
  Four sample;
  Four slope;     // of the tone curve there
  Four contrast;  // black less white
  Four dark;      // share of the stroke's light
  Four z_inner, z_outer;
  Four d_inner, d_outer;  // densities at the two edges
};

Predicted predict(const StepModel& model, const FourSamples& at) {
  const NormalTable& normal = NormalTable::get();
  Predicted predicted;
  predicted.z_inner = (at.across - model.place - model.turn * at.along) * model.per_blur;
  predicted.z_outer = predicted.z_inner - model.stroke_at(at.along) * model.per_blur;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const NormalValue inner = normal(predicted.z_inner[i]), outer = normal(predicted.z_outer[i]);
    predicted.dark[i] = inner.integral - outer.integral;
    predicted.d_inner[i] = inner.density;
    predicted.d_outer[i] = outer.density;
  }
  const Four white = model.white + model.white_slope * at.along;
  predicted.contrast = model.black + model.black_slope * at.along - white;
  const Four light = white + predicted.contrast * predicted.dark;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const ToneCurve::Point point = model.tone.point_of(light[i]);
    predicted.sample[i] = point.sample;
    predicted.slope[i] = point.slope;
  }
  return predicted;
}

struct NormalEquations {
  Eigen::Matrix<double, kParameters, kParameters> matrix =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Parameters right = Parameters::Zero();
  double cost = 0;
  double weight = 0;
  double squares = 0;  // weighted squares of the residuals
  double count = 0;
};

// What four samples add to the normal equations, by the root of their weights: the prediction's
// change with each parameter, and the residual.
struct WeighedSamples {
  Eigen::Matrix<float, kParameters, 4> terms;
  Eigen::Vector4f residual;
  Four weight;
  Four cost;
};

// Cauchy weights with the scale of the current residuals keep dirt and glare from pulling.
WeighedSamples weighed(const StepModel& model, const FourSamples& samples, float per_scale) {
  const Predicted predicted = predict(model, samples);
  const Four residual = samples.value - predicted.sample;
  const Four ratio2 = (residual * per_scale).square();
  WeighedSamples weighed;
  weighed.weight = samples.weight / (1 + ratio2);
  weighed.cost = samples.weight * (1 + ratio2).log();
  const Four root = weighed.weight.sqrt();
  weighed.residual = (root * residual).matrix();
  const Four by_light = root * predicted.slope;
  const Four by_dark = by_light * predicted.contrast;
  const Four by_place = by_dark * (predicted.d_outer - predicted.d_inner) * model.per_blur;
  const Four by_white = by_light * (1 - predicted.dark), by_black = by_light * predicted.dark;
  auto row = [&](int parameter) { return weighed.terms.row(parameter).array().transpose(); };
  row(kPlace) = by_place;
  row(kTurn) = by_place * samples.along;
  row(kLogBlur) =
      by_dark * (predicted.z_outer * predicted.d_outer - predicted.z_inner * predicted.d_inner);
  row(kWhite) = by_white;
  row(kWhiteSlope) = by_white * samples.along;
  row(kBlack) = by_black;
  row(kBlackSlope) = by_black * samples.along;
  row(kLogStroke) = by_dark * predicted.d_outer * model.stroke_at(samples.along) * model.per_blur;
  return weighed;
}

NormalEquations accumulate(const Parameters& p, const SideSamples& samples, const SideLine& side,
                           double scale) {
  const StepModel model(p, side, samples.tone);
  const float per_scale = 1 / static_cast<float>(scale);
  Four cost = Four::Zero(), total = Four::Zero();
  float squares = 0;
  Eigen::Matrix<float, kParameters, kParameters> matrix;
  matrix.setZero();
  Eigen::Matrix<float, kParameters, 1> right;
  right.setZero();
  for (const FourSamples& four : samples.fours) {
    const WeighedSamples rows = weighed(model, four, per_scale);
    matrix.noalias() += rows.terms * rows.terms.transpose();
    right.noalias() += rows.terms * rows.residual;
    squares += rows.residual.squaredNorm();
    cost += rows.cost;
    total += rows.weight;
  }
  NormalEquations normal{matrix.cast<double>(), right.cast<double>()};
  normal.squares = static_cast<double>(squares);
  normal.weight = static_cast<double>(total.sum());
  // The stroke is about as thick as guessed; where its far edge is out of sight, that is all there
  // is.
  const double stroke_weight = scale * scale / (kEdgeFit.stroke_sigma * kEdgeFit.stroke_sigma);
  const double stroke_residual = std::log(side.stroke) - p[kLogStroke];
  normal.matrix(kLogStroke, kLogStroke) += stroke_weight;
  normal.right[kLogStroke] += stroke_weight * stroke_residual;
  normal.cost = scale * scale * static_cast<double>(cost.sum()) +
                stroke_weight * stroke_residual * stroke_residual;
  normal.count = static_cast<double>(samples.samples.size());
  return normal;
}

Parameters first_guess(const SideSamples& samples, const SideLine& side, double blur) {
  double white = 0, black = 0, whites = 0, blacks = 0;
  for (const EdgeSample& sample : samples.samples) {
    const double light = samples.tone.light_of(static_cast<int>(std::lround(sample.value)));
    const auto weight = static_cast<double>(sample.weight);
    const auto across = static_cast<double>(sample.across);
    if (across < -0.4 * side.reach) {
      white += weight * light;
      whites += weight;
    } else if (across > 0.3 * side.stroke && across < 0.7 * side.stroke) {
      black += weight * light;
      blacks += weight;
    }
  }
  Parameters p = Parameters::Zero();
  p[kWhite] = whites > 0 ? white / whites : 0.5;
  p[kBlack] = blacks > 0 ? black / blacks : 0.05;
  p[kLogBlur] = std::log(blur);
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
double noise_scale(const SideSamples& samples, const Parameters& p, const SideLine& side) {
  const StepModel model(p, side, samples.tone);
  std::vector<float> residuals;
  for (const FourSamples& four : samples.fours) {
    const Four off = (four.value - predict(model, four).sample).abs();
    residuals.insert(residuals.end(), off.begin(), off.end());
  }
  residuals.resize(samples.samples.size());
  return std::max(kEdgeFit.least_residual,
                  2 * static_cast<double>(quantile(residuals, 0.5)) / 0.6745);
}

struct Solution {
  Parameters parameters;
  NormalEquations normal;
  double scale = 1;  // of the weights
};

// With the weights' scale held; at most `most_steps` steps.
Solution minimise(const SideSamples& samples, const SideLine& side, Parameters p, double scale,
                  int most_steps) {
  const NormalEquations found = minimise_damped(
      p, {most_steps, kEdgeFit.settled},
      [&](const Parameters& at) { return accumulate(at, samples, side, scale); },
      [&](Parameters& at) { constrain(at, side.stroke); });
  return {p, found, scale};
}

// First with the scale of the guess, then with that of what was found.
Solution solve_from(const SideSamples& samples, const SideLine& side, Parameters p) {
  constrain(p, side.stroke);
  p = minimise(samples, side, p, noise_scale(samples, p, side), 4).parameters;
  return minimise(samples, side, p, noise_scale(samples, p, side), 15);
}

double cost_of(const Solution& solution) { return solution.normal.cost / solution.normal.weight; }

// The edge's place by the share of the samples that is bright; nothing where the stroke's far edge
// is among them.
std::optional<double> place_by_share(const SideSamples& samples, const SideLine& side) {
  if (side.stroke < kEdgeFit.thin_stroke) return std::nullopt;
  std::vector<float> values;
  float from = 0, to = 0;
  for (const EdgeSample& sample : samples.samples) {
    values.push_back(sample.value);
    from = std::min(from, sample.across);
    to = std::max(to, sample.across);
  }
  const float white = quantile(values, 0.9), black = quantile(values, 0.1);
  float bright = 0, all = 0;
  for (const EdgeSample& sample : samples.samples) {
    if (sample.value > (white + black) / 2) bright += sample.weight;
    all += sample.weight;
  }
  return static_cast<double>(from + (to - from) * bright / all);
}

// A sharp edge far from where it was sought looks like dirt on the white or the black there, and
// the robust fit stays where it began: then the edge is sought from where the light says it is.
Solution solve_side(const SideSamples& samples, const SideLine& side, double start_blur) {
  Parameters start = first_guess(samples, side, start_blur);
  Solution first = solve_from(samples, side, start);
  const std::optional<double> place = place_by_share(samples, side);
  if (!place || std::abs(*place - first.parameters[kPlace]) < kEdgeFit.fine) return first;
  start[kPlace] = *place;
  Solution second = solve_from(samples, side, start);
  return cost_of(second) < cost_of(first) ? second : first;
}

// Whether a fit explains as good as all of a side's samples.
bool fits_all(const SideSamples& samples, const Solution& solution) {
  double weight = 0;
  for (const EdgeSample& sample : samples.samples) weight += static_cast<double>(sample.weight);
  const Parameters& p = solution.parameters;
  const auto level = [&](double light) {
    return static_cast<double>(samples.tone.point_of(static_cast<float>(light)).sample);
  };
  const double contrast = level(p[kWhite]) - level(p[kBlack]);
  return solution.normal.weight > kEdgeFit.least_fitting * weight &&
         solution.scale < std::max(2 * kEdgeFit.least_residual, kEdgeFit.most_residual * contrast);
}

// A side by the part of it that shows, where the fit to all of it leaves many samples aside.
struct SolvedSide {
  SideLine line;  // near which it was sampled
  SideSamples samples;
  Solution solution;
};

SolvedSide solve_shown(const GrayView& image, const SideLine& side, double thin,
                       SideSamples samples) {
  Solution all = solve_side(samples, side, kEdgeFit.start_blur);
  const double slice_px = distance(side.begin, side.end) / kSlices;
  if (slice_px < kEdgeFit.least_slice || fits_all(samples, all)) {
    return {side, std::move(samples), all};
  }
  auto part = shown_part(edge_samples(image, side, thin, kSlices), all.scale);
  if (!part) return {side, std::move(samples), all};
  // What covers a side has put it a few pixels aside, where the edge is hardly among the samples.
  SideLine line = moved(side, part->place - part->turn, part->place + part->turn);
  if (auto nearer = shown_part(edge_samples(image, line, thin, kSlices), all.scale)) {
    part = std::move(nearer);
  } else {
    line = side;
  }
  if (part->samples.size() < kLeastSamples) return {side, std::move(samples), all};
  SideSamples shown(image, std::move(part->samples));
  Parameters start = first_guess(shown, line, kEdgeFit.start_blur);
  start[kPlace] = part->place;
  start[kTurn] = part->turn;
  const Solution solution = solve_from(shown, line, start);
  return {line, std::move(shown), solution};
}

// Of a sample's value by its residual, at least that of the rounding to whole grey levels.
double noise_variance(const NormalEquations& normal) {
  return std::max(1.0 / 12, normal.squares / (normal.count - kParameters));
}

// Of the edge's place at the side's begin and end: the inverse normal matrix by the noise.
Eigen::Matrix2d covariance_of(const NormalEquations& normal) {
  const double variance = noise_variance(normal);
  const Eigen::Matrix<double, kParameters, kParameters> matrix =
      normal.matrix.selfadjointView<Eigen::Lower>();
  Eigen::Matrix<double, kParameters, 2> ends = Eigen::Matrix<double, kParameters, 2>::Zero();
  ends.row(kPlace) << 1, 1;
  ends.row(kTurn) << -1, 1;
  return variance * (ends.transpose() * matrix.ldlt().solve(ends));
}

// How far the samples of a fitted side say that its middle is off the bow that it was fitted with:
// one more parameter, eliminated from the others (a Schur complement).
SeenSagitta seen_bow(const SideSamples& samples, const SideLine& side, const Solution& solution) {
  const NormalEquations& normal = solution.normal;
  const StepModel model(solution.parameters, side, samples.tone);
  const auto count = static_cast<Eigen::Index>(4 * samples.fours.size());
  Eigen::VectorXf by_bow(count);
  Eigen::Matrix<float, Eigen::Dynamic, kParameters + 1> rows(count, kParameters + 1);
  for (Eigen::Index i = 0; i < count; i += 4) {
    const FourSamples& four = samples.fours[static_cast<std::size_t>(i / 4)];
    const WeighedSamples here = weighed(model, four, 1 / static_cast<float>(solution.scale));
    rows.middleRows<4>(i) << here.terms.transpose(), here.residual;
    by_bow.segment<4>(i) =
        here.terms.row(kPlace).transpose().cwiseProduct((1 - four.along.square()).matrix());
  }
  const Eigen::Matrix<double, kParameters + 1, 1> products =
      (rows.transpose() * by_bow).cast<double>();
  const Parameters right =
      (rows.leftCols<kParameters>().transpose() * rows.col(kParameters)).cast<double>();
  const Parameters shared = products.head<kParameters>();
  const Parameters eliminated = normal.matrix.ldlt().solve(shared);
  const double information = static_cast<double>(by_bow.squaredNorm()) - shared.dot(eliminated);
  if (!(information > 0)) return {};
  const double noise = noise_variance(normal);
  const double blur = std::exp(solution.parameters[kLogBlur]);
  const double stroke = std::exp(solution.parameters[kLogStroke]);
  const double unexplained =
      std::hypot(kCorner.bow, kCorner.bow_blurred * std::pow(blur / stroke, 2));
  return {(products[kParameters] - eliminated.dot(right)) / information,
          kCorner.alike * noise / information + unexplained * unexplained};
}

// By how much noise that is alike in neighbouring places raises a fit's variance.
double correlation_of_noise(const SideSamples& samples, const Solution& solution,
                            const SideLine& side) {
  const StepModel model(solution.parameters, side, samples.tone);
  std::vector<float> residuals;
  for (const FourSamples& four : samples.fours) {
    const WeighedSamples rows = weighed(model, four, 1 / static_cast<float>(solution.scale));
    residuals.insert(residuals.end(), rows.residual.begin(), rows.residual.end());
  }
  return correlation_factor(residuals);
}

struct SideFit {
  SideLine line;
  FrameSide side;
};

SideFit describe(const Solution& solution, const SideLine& side) {
  const Parameters& p = solution.parameters;
  SideFit fit;
  fit.line = moved(side, p[kPlace] - p[kTurn], p[kPlace] + p[kTurn]);
  fit.side.covariance = covariance_of(solution.normal);
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
SideFit fit_again(const SideSamples& samples, const SideLine& side, double start_blur,
                  const Solution& first) {
  const Solution second = solve_side(samples, side, start_blur);
  const bool better = cost_of(second) < cost_of(first);
  const Solution& chosen = better && stays_near(second, side) ? second : first;
  return describe(chosen, side);
}

}  // namespace

namespace {

// Where frames are fitted, and of which proportions.
struct Sight {
  const GrayView& image;
  const FrameShape& shape;
  bool was_sharpened = false;
};

// The frame fitted through one lens, and what its sides say of another.
struct FrameFit {
  RefinedFrame frame;
  std::array<SeenSagitta, 4> bows;
};

// `beyond`: by how much the sides' middles bow beyond what the lens gives.
FrameResult<FrameFit> fit_frame(const Sight& sight, const Quad& settled, const LensDistortion& lens,
                                const std::array<double, 4>& beyond) {
  std::array<SideLine, 4> lines{};
  std::vector<SideSamples> samples;
  samples.reserve(4);
  std::array<Solution, 4> solutions{};
  std::array<double, 4> blurs{};
  const SideSagittas bows = sagittas_of(lens, settled);
  const double thin = sight.was_sharpened ? kSharpening.thin_stroke : kEdgeFit.thin_stroke;
  for (std::size_t i = 0; i < 4; ++i) {
    lines[i] = side_of(settled, i, sight.shape);
    lines[i].taper = taper_of(settled, lines[i], i);
    lines[i].bow = bows[i];
    lines[i].bow.c[0] += beyond[i];
    SideSamples all(sight.image, edge_samples(sight.image, lines[i], thin));
    if (all.samples.size() < kLeastSamples) return fail(FrameFault::side_too_short);
    SolvedSide solved = solve_shown(sight.image, lines[i], thin, std::move(all));
    lines[i] = solved.line;
    samples.push_back(std::move(solved.samples));
    solutions[i] = solved.solution;
    if (!stays_near(solutions[i], lines[i])) {
      return fail(FrameFault::no_fit);
    }
    blurs[i] = solutions[i].parameters[kLogBlur];
  }
  std::ranges::sort(blurs);
  const double common_blur = (blurs[1] + blurs[2]) / 2;  // logarithm of
  FrameFit result;
  for (std::size_t i = 0; i < 4; ++i) {
    result.bows[i] = seen_bow(samples[i], lines[i], solutions[i]);
    const bool alike =
        std::abs(solutions[i].parameters[kLogBlur] - common_blur) < kEdgeFit.different_blur;
    SideFit fit = alike ? describe(solutions[i], lines[i])
                        : fit_again(samples[i], lines[i], std::exp(common_blur), solutions[i]);
    if (sight.was_sharpened) {
      fit.side.covariance *= correlation_of_noise(samples[i], solutions[i], lines[i]);
    }
    lines[i] = fit.line;
    result.frame.sides[i] = fit.side;
  }
  const std::optional<Quad> corners = corners_of(lines);
  if (!corners) return fail(FrameFault::not_closed);
  result.frame.corners = *corners;
  result.frame.lens = lens;
  return result;
}

// Fits the frame through a known lens, anew while the corners from which its bows were reckoned
// move: a side's bow grows with its distance from the lens's centre.
FrameResult<RefinedFrame> fit_with_known_lens(const Sight& sight, const Quad& settled,
                                              const LensDistortion& lens) {
  FrameResult<FrameFit> fit = fit_frame(sight, settled, lens, {});
  if (!fit) return tl::unexpected(fit.error());
  Quad from = settled;
  for (int round = 1; round < kEdgeFit.rounds && lens.bends(); ++round) {
    const Quad& corners = fit->frame.corners;
    double moved = 0;
    for (std::size_t i = 0; i < 4; ++i) moved = std::max(moved, distance(corners[i], from[i]));
    if (moved < kEdgeFit.at_rest) break;
    from = corners;
    FrameResult<FrameFit> again = fit_frame(sight, from, lens, {});
    if (!again) break;
    fit = std::move(again);
  }
  return fit->frame;
}

// What the sides of a frame tell of an unknown lens: one for all of them, and of each by how much
// it bows beyond that, for real lenses are not quite of one model.
struct ToldLens {
  RadialLens radial;
  std::array<double, 4> beyond{};
};

FrameResult<FrameFit> fit_frame(const Sight& sight, const Quad& settled, PixelPoint centre,
                                const ToldLens& told) {
  const LensDistortion lens = LensDistortion::radial(centre, told.radial.lambda);
  return fit_frame(sight, settled, lens, told.beyond);
}

// What a side that bows more than its lens says may be off by: the square of two thirds of that,
// where it is no noise.
double bow_doubt(const SeenSagitta& seen) {
  const double square = seen.beyond * seen.beyond;
  return square > kLens.clear * kLens.clear * seen.variance ? 4.0 / 9 * square : 0;
}

// What a lens that does not show adds to the covariances of sides that were fitted straight.
void add_unseen_lens_doubt(FrameFit& fit, PixelPoint centre) {
  const UnseenLens unseen = unseen_lens(fit.frame.corners, fit.bows, centre);
  fit.frame.lens_doubt = unseen.lambda;
  for (std::size_t i = 0; i < 4; ++i) {
    const double doubt =
        std::max(4.0 / 9 * unseen.bows[i] * unseen.bows[i], bow_doubt(fit.bows[i]));
    fit.frame.sides[i].covariance += Eigen::Matrix2d::Constant(doubt);
  }
}

// What an unknown lens adds to the sides' covariances: a line fitted to a bow stands off its ends
// by two thirds of it, and real lenses bow sides in ways that are not quite those of the model.
void add_lens_doubt(FrameFit& fit) {
  const SideSagittas bows = sagittas_of(fit.frame.lens, fit.frame.corners);
  for (std::size_t i = 0; i < 4; ++i) {
    const double shape = kLens.shape * bows[i].middle();
    fit.frame.sides[i].covariance += Eigen::Matrix2d::Constant(4.0 / 9 * fit.bows[i].variance) +
                                     Eigen::Matrix2d::Identity() * shape * shape;
  }
}

// Fits the frame and what its sides tell of the lens in turn, until neither changes.
FrameResult<RefinedFrame> fit_with_lens(const Sight& sight, const Quad& settled, PixelPoint centre,
                                        double lambda) {
  ToldLens told{{lambda, 0}, {}};
  FrameResult<FrameFit> fit = fit_frame(sight, settled, centre, told);
  if (!fit && lambda != 0) {
    told = {};
    fit = fit_frame(sight, settled, centre, told);
  }
  if (!fit) return tl::unexpected(fit.error());
  const auto fit_again = [&](const ToldLens& next) {
    FrameResult<FrameFit> again = fit_frame(sight, fit->frame.corners, centre, next);
    if (!again) return false;
    fit = std::move(again);
    told = next;
    return true;
  };
  for (int round = 0; round < kEdgeFit.rounds; ++round) {
    const double now = told.radial.lambda;
    const auto radial = lens_of_sides(fit->frame.corners, fit->bows, centre, now);
    if (!radial) {
      if (now != 0 && !fit_again({})) break;
      add_unseen_lens_doubt(*fit, centre);
      return fit->frame;
    }
    if (std::abs(radial->lambda - now) < radial->sigma) break;
    if (!fit_again({*radial, {}})) break;
  }
  for (int round = 0; round < kEdgeFit.rounds; ++round) {
    ToldLens next = told;
    for (std::size_t i = 0; i < 4; ++i) next.beyond[i] += fit->bows[i].beyond;
    if (!fit_again(next)) break;
  }
  add_lens_doubt(*fit);
  fit->frame.lens_doubt = std::abs(told.radial.lambda);  // of the model its sides alone are sure
  return fit->frame;
}

}  // namespace

RefinedFrame turned_to(RefinedFrame frame, std::size_t first) {
  const auto turn = [&](auto& four) {
    std::rotate(four.begin(), four.begin() + static_cast<std::ptrdiff_t>(first), four.end());
  };
  turn(frame.corners);
  turn(frame.sides);
  turn(frame.shown);
  return frame;
}

FrameResult<RefinedFrame> refine_frame(const GrayView& image, const Quad& settled,
                                       const LensGuess& lens, const FrameShape& shape,
                                       bool was_sharpened) {
  const Sight sight{image, shape, was_sharpened};
  const PixelPoint centre{(image.width - 1) / 2.0, (image.height - 1) / 2.0};
  FrameResult<RefinedFrame> frame = lens.known ? fit_with_known_lens(sight, settled, *lens.known)
                                               : fit_with_lens(sight, settled, centre, lens.lambda);
  if (frame) frame->was_sharpened = was_sharpened;
  return frame;
}

namespace {

// Levels, blur and stroke of a side that does not show: the mean of those that do.
FrameSide hidden_side(const RefinedFrame& frame, double sigma) {
  FrameSide mean;
  double count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!frame.shown[i]) continue;
    const FrameSide& side = frame.sides[i];
    mean.blur_px += side.blur_px;
    mean.stroke_px += side.stroke_px;
    mean.white_begin += (side.white_begin + side.white_end) / 2;
    mean.black_begin += (side.black_begin + side.black_end) / 2;
    ++count;
  }
  mean.blur_px /= count;
  mean.stroke_px /= count;
  mean.white_begin /= count;
  mean.black_begin /= count;
  mean.white_end = mean.white_begin;
  mean.black_end = mean.black_begin;
  mean.covariance = sigma * sigma * Eigen::Matrix2d::Identity();
  return mean;
}

}  // namespace

FrameResult<RefinedFrame> refine_shown_sides(const GrayView& image, const Quad& settled,
                                             const std::array<bool, 4>& shown, double hidden_sigma,
                                             const LensDistortion& lens, const FrameShape& shape) {
  constexpr std::ptrdiff_t kLeastShown = 2;
  std::array<SideLine, 4> lines{};
  RefinedFrame frame;
  frame.lens = lens;
  const SideSagittas bows = sagittas_of(lens, settled);
  double most_doubt = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    lines[i] = side_of(settled, i, shape);
    lines[i].taper = taper_of(settled, lines[i], i);
    lines[i].bow = bows[i];
    frame.shown[i] = false;
    if (!shown[i]) continue;
    SideSamples all(image, edge_samples(image, lines[i]));
    if (all.samples.size() < kLeastSamples) continue;
    const auto [line, samples, solution] =
        solve_shown(image, lines[i], kEdgeFit.thin_stroke, std::move(all));
    if (!stays_near(solution, line)) continue;
    const double doubt = bow_doubt(seen_bow(samples, line, solution));
    const SideFit fit = describe(solution, line);
    lines[i] = fit.line;
    frame.sides[i] = fit.side;
    frame.shown[i] = true;
    frame.sides[i].covariance += Eigen::Matrix2d::Constant(doubt);
    most_doubt = std::max(most_doubt, doubt);
  }
  if (std::ranges::count(frame.shown, true) < kLeastShown) {
    return fail(FrameFault::covered);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (frame.shown[i]) continue;
    frame.sides[i] = hidden_side(frame, hidden_sigma);
    frame.sides[i].covariance += Eigen::Matrix2d::Constant(most_doubt);
  }
  const std::optional<Quad> corners = corners_of(lines);
  if (!corners) return fail(FrameFault::not_closed);
  frame.corners = *corners;
  return frame;
}

}  // namespace tagsmith::detail
