// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/symbol_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/scan/symbol_edges.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kParameters = 8;
enum : int { kLogBlur, kShift, kStretch, kBend, kGrowth, kWhite, kBlack, kShading };
using Parameters = Eigen::Matrix<double, kParameters, 1>;
using ParameterMatrix = Eigen::Matrix<double, kParameters, kParameters>;

Parameters pack(const ImagingModel& image) {
  Parameters p;
  p << std::log(image.blur), image.shift, image.stretch, image.bend, image.growth, image.white,
      image.black, image.shading;
  return p;
}

ImagingModel unpack(const Parameters& p, double pixel) {
  return {std::exp(p[kLogBlur]), p[kShift], p[kStretch], p[kBend], p[kGrowth], p[kWhite], p[kBlack],
          p[kShading],           pixel};
}

using Row = Eigen::Matrix<float, kParameters, 1>;

// A place's darkness: how it changes with the parameters and what is left of it, both in standard
// deviations.
struct WeighedPlace {
  Row by_parameter = Row::Zero();
  float residual = 0;
};

float root_weight(const ScanBin& bin) { return 1 / std::sqrt(static_cast<float>(bin.variance)); }

std::vector<float> root_weights(const ScanProfile& profile) {
  std::vector<float> weights(profile.size());
  for (std::size_t i = 0; i < profile.size(); ++i) weights[i] = root_weight(profile[i]);
  return weights;
}

// How the darkness at a place changes with the parameters, in standard deviations.
Row weighed(const BarShare& bars, float from_middle, float weight, float contrast) {
  const float scale = contrast * weight;
  return Row{{scale * bars.by_log_blur, scale * bars.by_shift, scale * bars.by_stretch,
              scale * bars.by_bend, scale * bars.by_growth, weight * (1 - bars.share),
              weight * bars.share, weight * from_middle}};
}

// Standard deviations of a profile's darkness from what an image has there, squared and summed up.
TAGSMITH_WIDE float cost_of(const ImagingModel& image, const ScanPlaces& places,
                            const std::vector<float>& darkness, const std::vector<float>& weights,
                            std::vector<float>& shares) {
  const auto white = static_cast<float>(image.white);
  const auto contrast = static_cast<float>(image.black - image.white);
  const auto shading = static_cast<float>(image.shading);
  const std::size_t size = places.size();
  const float *dark = darkness.data(), *weight = weights.data(), *t = places.from_middle.data();
  float* residuals = shares.data();
  for (std::size_t i = 0; i < size; ++i) {
    const float expected = white + contrast * residuals[i] + shading * t[i];
    residuals[i] = weight[i] * (dark[i] - expected);
  }
  float cost = 0;
  for (std::size_t i = 0; i < size; ++i) cost += residuals[i] * residuals[i];
  return cost;
}

// A quadratic function about some parameters.
struct NormalEquations {
  ParameterMatrix matrix = ParameterMatrix::Zero();
  Parameters right = Parameters::Zero();
};

void add_priors(ParameterMatrix& matrix) {
  for (int i = 0; i < kParameters; ++i) {
    const double sigma = kSymbolFit.prior_sigma[static_cast<std::size_t>(i)];
    matrix(i, i) += 1 / (sigma * sigma);
  }
}

NormalEquations normal_equations(const std::vector<WeighedPlace>& places) {
  Eigen::Matrix<float, kParameters, kParameters> squares;
  Row right = Row::Zero();
  squares.setZero();
  for (const WeighedPlace& place : places) {
    squares.noalias() += place.by_parameter * place.by_parameter.transpose();
    right += place.residual * place.by_parameter;
  }
  NormalEquations normal{squares.cast<double>(), right.cast<double>()};
  add_priors(normal.matrix);
  return normal;
}

// A profile to be explained by given digits.
class FitProblem {
 public:
  FitProblem(const ScanProfile& profile, const Digits& digits, const ImagingModel& nominal)
      : places_(profile),
        digits_(digits),
        nominal_(pack(nominal)),
        pixel_(nominal.pixel),
        weights_(root_weights(profile)),
        darkness_(profile.size()) {
    for (std::size_t i = 0; i < profile.size(); ++i) {
      darkness_[i] = static_cast<float>(profile[i].darkness);
    }
  }

  struct Cost {
    double profile = 0;
    double prior = 0;
    double all() const { return profile + prior; }
  };

  Cost cost_at(const Parameters& p) const {
    const ImagingModel image = unpack(p, pixel_);
    std::vector<float> shares = SymbolEdges(image, digits_).shares_at(places_);
    return {static_cast<double>(cost_of(image, places_, darkness_, weights_, shares)),
            prior_cost(p)};
  }

  // The same from the places, which take half as long again to work out.
  Cost cost_at(const Parameters& p, const std::vector<WeighedPlace>& places) const {
    float cost = 0;
    for (const WeighedPlace& place : places) cost += place.residual * place.residual;
    return {static_cast<double>(cost), prior_cost(p)};
  }

  std::vector<WeighedPlace> places_at(const Parameters& p) const {
    const ImagingModel image = unpack(p, pixel_);
    const std::vector<BarShare> bars = SymbolEdges(image, digits_).with_derivatives_at(places_);
    const auto white = static_cast<float>(image.white);
    const auto contrast = static_cast<float>(image.black - image.white);
    const auto shading = static_cast<float>(image.shading);
    std::vector<WeighedPlace> all(bars.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      const float t = places_.from_middle[i];
      const float expected = white + contrast * bars[i].share + shading * t;
      all[i] = {weighed(bars[i], t, weights_[i], contrast),
                weights_[i] * (darkness_[i] - expected)};
    }
    return all;
  }

  NormalEquations equations_at(const Parameters& p, const std::vector<WeighedPlace>& places) const {
    NormalEquations normal = normal_equations(places);
    for (int i = 0; i < kParameters; ++i) {
      const double sigma = kSymbolFit.prior_sigma[static_cast<std::size_t>(i)];
      normal.right[i] += (nominal_[i] - p[i]) / (sigma * sigma);
    }
    return normal;
  }

 private:
  double prior_cost(const Parameters& p) const {
    double cost = 0;
    for (int i = 0; i < kParameters; ++i) {
      const double sigma = kSymbolFit.prior_sigma[static_cast<std::size_t>(i)];
      const double off = nominal_[i] - p[i];
      cost += off * off / (sigma * sigma);
    }
    return cost;
  }

  ScanPlaces places_;
  Digits digits_;
  Parameters nominal_;
  double pixel_;
  std::vector<float> weights_;
  std::vector<float> darkness_;
};

double total_variation(const ScanProfile& profile) {
  double weight = 0, sum = 0;
  for (const ScanBin& bin : profile) {
    weight += 1 / bin.variance;
    sum += bin.darkness / bin.variance;
  }
  const double mean = sum / weight;
  double variation = 0;
  for (const ScanBin& bin : profile) {
    variation += (bin.darkness - mean) * (bin.darkness - mean) / bin.variance;
  }
  return variation;
}

}  // namespace

SymbolFit fit_symbol(const ScanProfile& profile, const Digits& digits, const ImagingModel& start) {
  ImagingModel nominal_image;
  nominal_image.blur = start.blur;
  nominal_image.pixel = start.pixel;
  const FitProblem problem(profile, digits, nominal_image);
  Parameters p = pack(start);
  std::vector<WeighedPlace> places = problem.places_at(p);
  FitProblem::Cost cost = problem.cost_at(p, places);
  NormalEquations normal = problem.equations_at(p, places);
  double damping = 1e-4;
  bool is_promising = true;  // after a step that was not taken, the next may not be either
  for (int step = 0; step < kSymbolFit.most_steps; ++step) {
    ParameterMatrix matrix = normal.matrix;
    matrix.diagonal() *= 1 + damping;
    Parameters next = p + matrix.ldlt().solve(normal.right);
    next[kLogBlur] = std::clamp(next[kLogBlur], std::log(0.05), std::log(4.0));
    if (is_promising) places = problem.places_at(next);
    const FitProblem::Cost tried =
        is_promising ? problem.cost_at(next, places) : problem.cost_at(next);
    if (!(tried.all() < cost.all())) {
      is_promising = false;
      damping *= 30;
      if (damping > 1e2) break;
      continue;
    }
    const double gain = cost.all() - tried.all();
    p = next;
    cost = tried;
    damping = std::max(1e-6, damping * 0.1);
    if (gain < kSymbolFit.settled * tried.all()) break;
    if (!is_promising) places = problem.places_at(p);
    normal = problem.equations_at(p, places);
    is_promising = true;
  }
  return {unpack(p, start.pixel), cost.profile,
          1 - cost.profile / std::max(total_variation(profile), 1e-12), 1};
}

std::vector<BarShare> bar_shares(const ScanProfile& profile, const ImagingModel& image,
                                 const Digits& digits) {
  return SymbolEdges(image, digits).with_derivatives_at(ScanPlaces(profile));
}

NuisanceCovariance nuisance_covariance(const ScanProfile& profile, const ImagingModel& image,
                                       const std::vector<BarShare>& bars) {
  const auto contrast = static_cast<float>(image.black - image.white);
  const ScanPlaces at(profile);
  std::vector<WeighedPlace> places(profile.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = {weighed(bars[i], at.from_middle[i], root_weight(profile[i]), contrast), 0};
  }
  // With matrix = L L^T, the parameters' covariance is L^-T L^-1.
  const Eigen::LLT<ParameterMatrix> root(normal_equations(places).matrix);
  const ParameterMatrix inverse = root.matrixL().solve(ParameterMatrix::Identity());
  NuisanceCovariance slack(places.size());
  for (std::size_t i = 0; i < slack.size(); ++i) {
    const double sigma = std::sqrt(profile[i].variance);
    slack[i] = (sigma * (inverse * places[i].by_parameter.cast<double>())).cast<float>();
  }
  return slack;
}

}  // namespace tagsmith::detail
