// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/fitted_side.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Cholesky>

#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/damped_steps.hpp"

namespace tagsmith::detail {

// ---- The part that shows its edge.

namespace {

// Where an edge may be in a slice, from white inside to black.
struct EdgePlace {
  int slice = 0;
  double along = 0;
  double across = 0;
};

// An edge's line in the coordinates of samples.
struct EdgeLine {
  double place = 0;
  double turn = 0;
  double bow = 0;  // how far its middle stands outwards from its ends

  double off(const EdgePlace& edge) const {
    return edge.across - place - turn * edge.along - bow * (1 - edge.along * edge.along);
  }
};

std::size_t slice_of(const EdgeSample& sample) {
  return static_cast<std::size_t>(zone_at(sample.along, kSlices));
}

// By which share of the brighter value the darker one is below it: the same in shadow as in light.
float contrast_of(float dark, float bright) { return (bright - dark) / std::max(1.0F, bright); }

// The falls of a slice from its white to its black; none where its contrast is much less than the
// side's.
void add_edges(std::vector<EdgeSample>& slice, int number, float contrast,
               std::vector<EdgePlace>& edges) {
  if (slice.size() < 4) return;
  std::ranges::sort(slice, {}, &EdgeSample::across);
  const auto [dark, bright] = std::ranges::minmax(slice, {}, &EdgeSample::value);
  const float least = static_cast<float>(kEdgeFit.slice_contrast) * contrast;
  if (contrast_of(dark.value, bright.value) < least) return;
  const float middle = (dark.value + bright.value) / 2;
  for (std::size_t i = 1; i < slice.size(); ++i) {
    const EdgeSample& before = slice[i - 1];
    const EdgeSample& after = slice[i];
    if (before.value < middle || after.value >= middle) continue;
    const float share = (before.value - middle) / (before.value - after.value);
    edges.push_back({number,
                     static_cast<double>(before.along + share * (after.along - before.along)),
                     static_cast<double>(before.across + share * (after.across - before.across))});
  }
}

// Which slices have an edge so near a line.
std::array<bool, kSlices> slices_on(const EdgeLine& line, const std::vector<EdgePlace>& edges,
                                    double tolerance) {
  std::array<bool, kSlices> on{};
  for (const EdgePlace& edge : edges) {
    if (std::abs(line.off(edge)) < tolerance) on[static_cast<std::size_t>(edge.slice)] = true;
  }
  return on;
}

std::ptrdiff_t count_on(const EdgeLine& line, const std::vector<EdgePlace>& edges,
                        double tolerance) {
  return std::ranges::count(slices_on(line, edges, tolerance), true);
}

// The bowed line through three edges.
EdgeLine through(const EdgePlace& a, const EdgePlace& b, const EdgePlace& c) {
  const double first = (b.across - a.across) / (b.along - a.along);
  const double second = (c.across - b.across) / (c.along - b.along);
  const double square = (second - first) / (c.along - a.along);
  const double turn = first - square * (a.along + b.along);
  return {a.across - turn * a.along + square * (1 - a.along * a.along), turn, -square};
}

// Whether one bow goes through all slices but one.
bool lie_on_bow(const std::vector<EdgePlace>& edges, double tolerance) {
  constexpr int kQuarter = kSlices / 4;
  for (const EdgePlace& a : edges) {
    if (a.slice >= kQuarter) continue;
    for (const EdgePlace& b : edges) {
      if (b.slice < kSlices / 2 - 2 || b.slice >= kSlices / 2 + 2) continue;
      for (const EdgePlace& c : edges) {
        if (c.slice < kSlices - kQuarter) continue;
        if (count_on(through(a, b, c), edges, tolerance) >= kSlices - 1) return true;
      }
    }
  }
  return false;
}

// The line through the edges of two slices that are not neighbours on which most slices lie.
EdgeLine best_line(const std::vector<EdgePlace>& edges, double tolerance) {
  EdgeLine best;
  std::ptrdiff_t most = 0;
  for (const EdgePlace& a : edges) {
    for (const EdgePlace& b : edges) {
      if (b.slice - a.slice < kSlices / 4) continue;
      const double turn = (b.across - a.across) / (b.along - a.along);
      const EdgeLine line{a.across - turn * a.along, turn, 0};
      const std::ptrdiff_t count = count_on(line, edges, tolerance);
      if (count <= most) continue;
      most = count;
      best = line;
    }
  }
  return best;
}

}  // namespace

std::optional<ShownPart> shown_part(std::vector<EdgeSample> samples, double noise) {
  std::array<std::vector<EdgeSample>, kSlices> slices;
  std::vector<float> values;
  for (const EdgeSample& sample : samples) {
    slices[slice_of(sample)].push_back(sample);
    values.push_back(sample.value);
  }
  if (values.empty()) return std::nullopt;
  const float bright = quantile(values, 0.9), dark = quantile(values, 0.1);
  std::vector<EdgePlace> edges;
  for (int i = 0; i < kSlices; ++i) {
    add_edges(slices[static_cast<std::size_t>(i)], i, contrast_of(dark, bright), edges);
  }
  const double tolerance =
      kEdgeFit.slice_off + 2 * noise / std::max(1.0, static_cast<double>(bright - dark));
  if (lie_on_bow(edges, tolerance)) return std::nullopt;
  const EdgeLine line = best_line(edges, tolerance);
  const auto on = slices_on(line, edges, tolerance);
  const auto count = std::ranges::count(on, true);
  if (count < kSlices / 2 || count == kSlices) return std::nullopt;
  std::erase_if(samples, [&](const EdgeSample& sample) { return !on[slice_of(sample)]; });
  return ShownPart{line.place, line.turn, std::move(samples)};
}

// ---- The fit.

// The samples of one side and the step that is fitted to them.
namespace side_step {

// Four samples at a time.
using Four = Eigen::Array4f;

// The light across a side: white, the stroke's black, white again, blurred. Parameters: edge place
// at the middle and its slope, log blur, white and black at the middle and their slopes, log
// stroke.
constexpr int kParameters = 8;
constexpr std::size_t kLeastSamples = 2 * std::size_t{kParameters};  // of a side
using Parameters = Eigen::Matrix<double, kParameters, 1>;
enum : int { kPlace, kTurn, kLogBlur, kWhite, kWhiteSlope, kBlack, kBlackSlope, kLogStroke };

// Four samples; places beyond a side's last sample have weight zero.
struct FourSamples {
  Four along = Four::Zero();
  Four across = Four::Zero();
  Four value = Four::Zero();
  Four weight = Four::Zero();
};

// The grey levels below and above which a share of the pixels lies: black and white, wherever
// between them the edge is.
std::pair<float, float> levels_of(std::vector<EdgeSample> samples, float share) {
  std::ranges::sort(samples, {}, &EdgeSample::value);
  float all = 0;
  for (const EdgeSample& sample : samples) all += sample.weight;
  float below = 0;
  float black = samples.front().value, white = samples.back().value;
  for (const EdgeSample& sample : samples) {
    if (below <= share * all) black = sample.value;
    below += sample.weight;
    if (below <= (1 - share) * all) white = sample.value;
  }
  return {black, white};
}

// The edge's place by the share of the samples that is bright; nothing where the stroke's far edge
// is among them, or there is no edge.
std::optional<double> place_by_share(const std::vector<EdgeSample>& samples, const SideLine& side) {
  if (samples.empty() || side.stroke < kEdgeFit.thin_stroke) return std::nullopt;
  float from = 0, to = 0;
  for (const EdgeSample& sample : samples) {
    from = std::min(from, sample.across);
    to = std::max(to, sample.across);
  }
  // Levels of a twentieth of the pixels at either end; they must differ by four times the noise.
  const auto [black, white] = levels_of(samples, 0.05F);
  if (white - black < 4 * static_cast<float>(kEdgeFit.least_residual)) return std::nullopt;
  float bright = 0, all = 0;
  for (const EdgeSample& sample : samples) {
    if (sample.value > (white + black) / 2) bright += sample.weight;
    all += sample.weight;
  }
  return static_cast<double>(from + (to - from) * bright / all);
}

// The samples of a side. Where they were evened out, the factors that their light was multiplied by
// at the side's begin and end.
struct SideSamples {
  SideSamples(const GrayView& image, const SideLine& side, std::vector<EdgeSample> of_side)
      : tone(ToneCurve::of(image)),
        samples(std::move(of_side)),
        fours((samples.size() + 3) / 4),
        likely_place(place_by_share(samples, side)) {
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
  std::vector<FourSamples> fours;      // the same
  std::optional<double> likely_place;  // of the edge, by the light
  double begin_gain = 1, end_gain = 1;
};

struct NormalEquations {
  Eigen::Matrix<double, kParameters, kParameters> matrix =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Parameters right = Parameters::Zero();
  double cost = 0;
  double weight = 0;
  double squares = 0;  // weighted squares of the residuals
  double count = 0;
};

struct Solution {
  Parameters parameters;
  NormalEquations normal;
  double scale = 1;  // of the weights
};

}  // namespace side_step

struct FittedSide::Solved {
  SideLine line;  // near which it was sampled
  side_step::SideSamples samples;
  side_step::Solution solution;
};

namespace {

using namespace side_step;
using Solved = FittedSide::Solved;

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
  // Eigen's own root of four floats starts from an approximation that differs between processors.
  const Four root = weighed.weight.unaryExpr([](float weight) { return std::sqrt(weight); });
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
    // Too small for the blocked product that Eigen would choose.
    matrix += rows.terms.lazyProduct(rows.terms.transpose());
    right += rows.terms.lazyProduct(rows.residual);
    squares += rows.residual.squaredNorm();
    cost += rows.cost;
    total += rows.weight;
  }
  NormalEquations normal{matrix.cast<double>(), right.cast<double>()};
  normal.squares = static_cast<double>(squares);
  normal.weight = static_cast<double>(total.sum());
  // The stroke is about as thick as guessed; where its far edge is not sampled, nothing else is
  // known of it.
  const double stroke_weight = scale * scale / (kEdgeFit.log_sigma * kEdgeFit.log_sigma);
  const double stroke_residual = std::log(side.stroke) - p[kLogStroke];
  normal.matrix(kLogStroke, kLogStroke) += stroke_weight;
  normal.right[kLogStroke] += stroke_weight * stroke_residual;
  normal.cost = scale * scale * static_cast<double>(cost.sum()) +
                stroke_weight * stroke_residual * stroke_residual;
  normal.count = static_cast<double>(samples.samples.size());
  return normal;
}

// Whether a sample is of the white inside the frame, beyond the blur of its edge.
bool is_white(const EdgeSample& sample, const SideLine& side) {
  return static_cast<double>(sample.across) < -0.4 * side.reach;
}

Parameters first_guess(const SideSamples& samples, const SideLine& side, double blur) {
  double white = 0, black = 0, whites = 0, blacks = 0;
  for (const EdgeSample& sample : samples.samples) {
    const double light = samples.tone.light_of(static_cast<int>(std::lround(sample.value)));
    const auto weight = static_cast<double>(sample.weight);
    const auto across = static_cast<double>(sample.across);
    if (is_white(sample, side)) {
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

// Scale of the Cauchy weights: twice the median residual, so that noise is fitted and dirt is not.
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

// With the weights' scale held; at most `most_steps` steps.
Solution minimise(const SideSamples& samples, const SideLine& side, Parameters p, double scale,
                  int most_steps) {
  const NormalEquations found = minimise_damped(
      p, {.most = most_steps},
      [&](const Parameters& at) { return accumulate(at, samples, side, scale); },
      [&](Parameters& at) { constrain(at, side.stroke); });
  return {p, found, scale};
}

// First with the scale of the guess, then with the scale of the solution.
Solution solve_from(const SideSamples& samples, const SideLine& side, Parameters p) {
  constrain(p, side.stroke);
  p = minimise(samples, side, p, noise_scale(samples, p, side), 4).parameters;
  return minimise(samples, side, p, noise_scale(samples, p, side), 15);
}

double cost_of(const Solution& solution) { return solution.normal.cost / solution.normal.weight; }

// A sharp edge far from the start looks like dirt on the white or the black there, and the robust
// fit stays where it began: then the fit is repeated from the place that the light gives.
Solution solve_side(const SideSamples& samples, const SideLine& side, double start_blur) {
  Parameters start = first_guess(samples, side, start_blur);
  Solution first = solve_from(samples, side, start);
  const std::optional<double>& place = samples.likely_place;
  if (!place || std::abs(*place - first.parameters[kPlace]) < kEdgeFit.fine) return first;
  start[kPlace] = *place;
  Solution second = solve_from(samples, side, start);
  return cost_of(second) < cost_of(first) ? second : first;
}

// Whether a fit explains nearly all of a side's samples.
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

// The samples as a side in even light would show them: those of each zone by its white, relative to
// the brightest. The light of a lamp's beam, or of a shadow that ends on a side, is not linear
// along it. Nothing where a zone shows no white.
std::optional<SideSamples> evenly_lit(const GrayView& image, const SideSamples& samples,
                                      const SideLine& side) {
  const auto zone_of = [](const EdgeSample& sample) {
    return static_cast<std::size_t>(zone_at(sample.along, kEdgeFit.zones));
  };
  const auto light_of = [&](const EdgeSample& sample) {
    return samples.tone.light_near(static_cast<double>(sample.value));
  };
  std::array<std::vector<float>, kEdgeFit.zones> whites;
  for (const EdgeSample& sample : samples.samples) {
    if (is_white(sample, side)) whites[zone_of(sample)].push_back(light_of(sample));
  }
  std::array<float, kEdgeFit.zones> white{};
  for (std::size_t i = 0; i < white.size(); ++i) {
    if (whites[i].empty()) return std::nullopt;
    white[i] = quantile(whites[i], 0.5);
    if (!(white[i] > 0)) return std::nullopt;
  }
  const float most = *std::ranges::max_element(white);
  std::vector<EdgeSample> even = samples.samples;
  for (EdgeSample& sample : even) {
    const float light = light_of(sample) * most / white[zone_of(sample)];
    sample.value = samples.tone.point_of(light).sample;
  }
  SideSamples made(image, side, std::move(even));
  made.begin_gain = static_cast<double>(most / white.front());
  made.end_gain = static_cast<double>(most / white.back());
  return made;
}

// A side by the part of it that shows its edge on one line; nothing where all of it does, or where
// it is too short to decide. `noise`: of a sample, grey levels.
std::optional<Solved> solve_shown(const GrayView& image, const SideLine& side, double thin,
                                  double noise) {
  if (distance(side.begin, side.end) < kSlices) return std::nullopt;
  auto part = shown_part(edge_samples(image, side, thin, kSlices), noise);
  if (!part) return std::nullopt;
  // A cover may have moved the side by a few pixels, so that its edge is hardly among the samples.
  SideLine line = moved(side, part->place - part->turn, part->place + part->turn);
  if (auto nearer = shown_part(edge_samples(image, line, thin, kSlices), noise)) {
    part = std::move(nearer);
  } else {
    line = side;
  }
  if (part->samples.size() < kLeastSamples) return std::nullopt;
  SideSamples shown(image, line, std::move(part->samples));
  Parameters start = first_guess(shown, line, kEdgeFit.start_blur);
  start[kPlace] = part->place;
  start[kTurn] = part->turn;
  const Solution solution = solve_from(shown, line, start);
  return Solved{line, std::move(shown), solution};
}

// A side that the edge of a shadow or of a lamp's beam crosses; nothing where even light does not
// explain it either.
std::optional<Solved> solve_evenly_lit(const GrayView& image, const SideLine& side,
                                       const SideSamples& samples) {
  auto even = evenly_lit(image, samples, side);
  if (!even) return std::nullopt;
  const Solution solution = solve_side(*even, side, kEdgeFit.start_blur);
  if (!fits_all(*even, solution)) return std::nullopt;
  return Solved{side, *std::move(even), solution};
}

// Whether the edge is among the samples.
bool is_near(const Solution& solution, const SideLine& side) {
  const Parameters& p = solution.parameters;
  return std::abs(p[kPlace]) + std::abs(p[kTurn]) < side.reach;
}

// A side whose stroke is half as thick as guessed: that of a plate seen so obliquely that its
// symbol is narrower than it is high. Nothing where that does not explain it either.
std::optional<Solved> solve_thinner(const GrayView& image, SideLine side, double thin) {
  side.stroke /= 2;
  SideSamples samples(image, side, edge_samples(image, side, thin));
  if (samples.samples.size() < kLeastSamples) return std::nullopt;
  const Solution solution = solve_side(samples, side, kEdgeFit.start_blur);
  if (!fits_all(samples, solution)) return std::nullopt;
  return Solved{side, std::move(samples), solution};
}

Solved solve(const GrayView& image, const SideLine& side, double thin, SideSamples samples) {
  const Solution all = solve_side(samples, side, kEdgeFit.start_blur);
  if (!fits_all(samples, all)) {
    if (auto shown = solve_shown(image, side, thin, all.scale)) return *std::move(shown);
    if (auto even = solve_evenly_lit(image, side, samples)) return *std::move(even);
    auto thinner = is_near(all, side) ? std::nullopt : solve_thinner(image, side, thin);
    if (thinner) return *std::move(thinner);
  }
  return {side, std::move(samples), all};
}

// Whether an edge lies where samples are close together, its blur included.
bool is_among_fine(double place, double turn) {
  return std::abs(place) + std::abs(turn) < kEdgeFit.fine / 2;
}

bool is_finely_sampled(const Solved& side) {
  const Parameters& p = side.solution.parameters;
  return is_among_fine(p[kPlace], p[kTurn]);
}

SideLine line_of(const Solved& side) {
  const Parameters& p = side.solution.parameters;
  return moved(side.line, p[kPlace] - p[kTurn], p[kPlace] + p[kTurn]);
}

// Nothing where samples are not close together at the edge that was found.
std::optional<Solved> solve_finely(const GrayView& image, const SideLine& side, double thin) {
  SideSamples samples(image, side, edge_samples(image, side, thin));
  if (samples.samples.size() < kLeastSamples) return std::nullopt;
  Solved found = solve(image, side, thin, std::move(samples));
  if (!is_finely_sampled(found)) return std::nullopt;
  return found;
}

// The variance of a sample's value from its residual, at least that of rounding to whole grey
// levels.
double noise_variance(const NormalEquations& normal) {
  return std::max(1.0 / 12, normal.squares / (normal.count - kParameters));
}

// The covariance of the edge's places at the side's begin and end: the inverse normal matrix times
// the noise.
Eigen::Matrix2d covariance_of(const NormalEquations& normal) {
  const double variance = noise_variance(normal);
  const Eigen::Matrix<double, kParameters, kParameters> matrix =
      normal.matrix.selfadjointView<Eigen::Lower>();
  Eigen::Matrix<double, kParameters, 2> ends = Eigen::Matrix<double, kParameters, 2>::Zero();
  ends.row(kPlace) << 1, 1;
  ends.row(kTurn) << -1, 1;
  return variance * (ends.transpose() * matrix.ldlt().solve(ends));
}

// How much farther from the model samples near either edge of the stroke are than those of even
// white and black: the difference of the mean weighted squares of the residuals, grey levels^2.
double excess_near_edge(const Solved& solved) {
  const auto& [side, samples, solution] = solved;
  const StepModel model(solution.parameters, side, samples.tone);
  const float per_scale = 1 / static_cast<float>(solution.scale);
  const auto mean = [](float sum, float count) { return sum / std::max(1.0F, count); };
  float near = 0, near_count = 0, far = 0, far_count = 0;
  for (const FourSamples& four : samples.fours) {
    const Four squares = weighed(model, four, per_scale).residual.array().square();
    const Four inner = four.across - model.place - model.turn * four.along;
    const Four from_edge = inner.abs().min((inner - model.stroke_at(four.along)).abs());
    const Four is_sample = (four.weight > 0).cast<float>();
    const Four is_near = is_sample * (from_edge < kEdgeFit.fine).cast<float>();
    near += (is_near * squares).sum();
    near_count += is_near.sum();
    far += ((is_sample - is_near) * squares).sum();
    far_count += (is_sample - is_near).sum();
  }
  return std::max(0.0, static_cast<double>(mean(near, near_count) - mean(far, far_count)));
}

// FrameSide::pixel_locking_px. Residuals by noise of that size would turn a side so much less often
// because they change along it.
double pixel_locking(const Solved& solved, const Eigen::Matrix2d& covariance) {
  const double turn_variance = (covariance(0, 0) + covariance(1, 1) - 2 * covariance(0, 1)) / 4;
  const double by_noise = noise_variance(solved.solution.normal);
  return kCorner.pixel_locking * std::sqrt(excess_near_edge(solved) / by_noise * turn_variance);
}

// The line of a large frame, which was found in a much reduced picture, may be farther from the
// edge than samples are taken: then it is moved by what the light shows.
SideLine brought_near(const GrayView& image, const SideLine& side) {
  const double band = 4 * side.reach;
  if (side.stroke < 2 * band) return side;
  const auto place = place_by_share(edge_samples_between(image, side, band, band), side);
  return place && std::abs(*place) > side.reach / 2 ? moved(side, *place, *place) : side;
}

}  // namespace

FittedSide::FittedSide(Solved solved) : solved_(std::make_unique<Solved>(std::move(solved))) {}
FittedSide::FittedSide(FittedSide&&) noexcept = default;
FittedSide& FittedSide::operator=(FittedSide&&) noexcept = default;
FittedSide::~FittedSide() = default;

std::optional<FittedSide> FittedSide::fit(const GrayView& image, const SideLine& sought,
                                          double thin) {
  const SideLine near = brought_near(image, sought);
  SideSamples all(image, near, edge_samples(image, near, thin));
  if (all.samples.size() < kLeastSamples) return std::nullopt;
  const auto place = all.likely_place;
  if (place && std::abs(*place) < near.reach && !is_among_fine(*place, 0)) {
    auto found = solve_finely(image, moved(near, *place, *place), thin);
    if (found) return FittedSide(*std::move(found));
  }
  FittedSide found(solve(image, near, thin, std::move(all)));
  if (is_finely_sampled(*found.solved_) || !found.stays_near()) return found;
  auto again = solve_finely(image, found.line(), thin);
  return again ? FittedSide(*std::move(again)) : std::move(found);
}

bool FittedSide::stays_near() const { return is_near(solved_->solution, solved_->line); }

double FittedSide::blur_px() const { return std::exp(solved_->solution.parameters[kLogBlur]); }

SideLine FittedSide::line() const { return line_of(*solved_); }

FrameSide FittedSide::side() const {
  const Parameters& p = solved_->solution.parameters;
  FrameSide side;
  side.covariance = covariance_of(solved_->solution.normal);
  side.pixel_locking_px = pixel_locking(*solved_, side.covariance);
  side.blur_px = blur_px();
  side.stroke_px = std::exp(p[kLogStroke]);
  const SideSamples& samples = solved_->samples;
  side.white_begin = (p[kWhite] - p[kWhiteSlope]) / samples.begin_gain;
  side.white_end = (p[kWhite] + p[kWhiteSlope]) / samples.end_gain;
  side.black_begin = (p[kBlack] - p[kBlackSlope]) / samples.begin_gain;
  side.black_end = (p[kBlack] + p[kBlackSlope]) / samples.end_gain;
  return side;
}

// One more parameter, eliminated from the others (a Schur complement).
SeenSagitta FittedSide::bow() const {
  const auto& [side, samples, solution] = *solved_;
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
  const double unexplained =  // the first by pixel locking
      std::hypot(0.015, kCorner.blurred * std::pow(blur / stroke, 2));
  return {(products[kParameters] - eliminated.dot(right)) / information,
          kCorner.alike * noise / information + unexplained * unexplained};
}

double FittedSide::noise_correlation() const {
  const auto& [side, samples, solution] = *solved_;
  const StepModel model(solution.parameters, side, samples.tone);
  std::vector<float> residuals;
  for (const FourSamples& four : samples.fours) {
    const WeighedSamples rows = weighed(model, four, 1 / static_cast<float>(solution.scale));
    residuals.insert(residuals.end(), rows.residual.begin(), rows.residual.end());
  }
  return correlation_factor(residuals);
}

void FittedSide::try_blur(double blur_px) {
  const Solution other = solve_side(solved_->samples, solved_->line, blur_px);
  if (cost_of(other) >= cost_of(solved_->solution)) return;
  if (is_near(other, solved_->line)) solved_->solution = other;
}

}  // namespace tagsmith::detail
