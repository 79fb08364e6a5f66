// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/symbol_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "decoder/scan/tuning.hpp"
#include "tagsmith/geometry/damped_steps.hpp"

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

// A place's darkness: how it changes with the parameters, and its residual, both in standard
// deviations.
struct WeighedPlace {
  Row by_parameter = Row::Zero();
  float residual = 0;
};

float root_weight(const ScanBin& bin) { return 1 / std::sqrt(static_cast<float>(bin.variance)); }

// How the darkness at a place changes with the parameters, in standard deviations.
Row weighed(const BarShare& bars, float from_middle, float weight, float contrast) {
  const float scale = contrast * weight;
  return Row{{scale * bars.by_log_blur, scale * bars.by_shift, scale * bars.by_stretch,
              scale * bars.by_bend, scale * bars.by_growth, weight * (1 - bars.share),
              weight * bars.share, weight * from_middle}};
}

// A quadratic function about some parameters.
struct NormalEquations {
  ParameterMatrix matrix = ParameterMatrix::Zero();
  Parameters right = Parameters::Zero();
  double of_profile = 0;  // squares of the profile's residuals
  double cost = 0;        // these and the cost of the priors
};

NormalEquations normal_equations(const std::vector<WeighedPlace>& places) {
  Eigen::Matrix<float, kParameters, kParameters> squares;
  Row right = Row::Zero();
  float cost = 0;
  squares.setZero();
  // The upper right quarter of the matrix repeats the lower left one.
  static_assert(kParameters == 8);
  for (const WeighedPlace& place : places) {
    const auto& terms = place.by_parameter;
    squares.leftCols<4>().noalias() += terms * terms.head<4>().transpose();
    squares.bottomRightCorner<4, 4>().noalias() += terms.tail<4>() * terms.tail<4>().transpose();
    right += place.residual * terms;
    cost += place.residual * place.residual;
  }
  squares.topRightCorner<4, 4>() = squares.bottomLeftCorner<4, 4>().transpose();
  return {squares.cast<double>(), right.cast<double>(), static_cast<double>(cost),
          static_cast<double>(cost)};
}

// Holds the parameters near nominal, or (-1) no longer; `off`: how far they are from there.
void add_priors(const Parameters& off, NormalEquations& normal, double sign = 1) {
  const ImagingTuning& sigma = kImaging;
  const Parameters sigmas{sigma.log_blur, sigma.edge,  sigma.stretch, sigma.edge,
                          sigma.edge,     sigma.level, sigma.level,   sigma.level};
  for (int i = 0; i < kParameters; ++i) {
    const double weight = sign / (sigmas[i] * sigmas[i]);
    normal.matrix(i, i) += weight;
    normal.right[i] -= weight * off[i];
    normal.cost += weight * off[i] * off[i];
  }
}

// A profile to be explained by given digits.
class FitProblem {
 public:
  FitProblem(const ScanProfile& profile, const Digits& digits, double pixel)
      : places_(profile),
        digits_(digits),
        pixel_(pixel),
        weights_(profile.size()),
        darkness_(profile.size()) {
    for (std::size_t i = 0; i < profile.size(); ++i) {
      weights_[i] = root_weight(profile[i]);
      darkness_[i] = static_cast<float>(profile[i].darkness);
    }
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

 private:
  ScanPlaces places_;
  Digits digits_;
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

// The equations with the priors at some parameters, and what they are of.
struct FitEquations : NormalEquations {
  Parameters at;
  std::vector<WeighedPlace> places;
  Parameters solution;  // no more than one small step from there
};

double most_log_blur() { return std::log(4.0); }

Parameters nominal_for(const ImagingModel& start) {
  ImagingModel nominal;
  nominal.blur = start.blur;
  return pack(nominal);
}

FitEquations minimise(const ScanProfile& profile, const Digits& digits, const ImagingModel& start,
                      const DampedSteps& steps) {
  const Parameters nominal = nominal_for(start);
  const FitProblem problem(profile, digits, start.pixel);
  Parameters p = pack(start);
  FitEquations found = minimise_damped(
      p, steps,
      [&](const Parameters& at) {
        std::vector<WeighedPlace> places = problem.places_at(at);
        FitEquations equations{normal_equations(places), at, std::move(places), at};
        add_priors(at - nominal, equations);
        return equations;
      },
      [&](Parameters& at) {
        at[kLogBlur] = std::clamp(at[kLogBlur], std::log(0.05), most_log_blur());
      });
  found.solution = p;
  return found;
}

// A third central moment m of the point spread changes the darkness by -m / 6 times its third
// derivative along the profile. That derivative times the square of the blur, in standard
// deviations: how the change with the blur's logarithm, which is the square of the blur times the
// second derivative, changes from place to place.
std::vector<double> by_third_moment(const ScanProfile& profile,
                                    const std::vector<WeighedPlace>& places) {
  const auto by_blur = [&](std::size_t i) {
    return static_cast<double>(places[i].by_parameter[kLogBlur]) * std::sqrt(profile[i].variance);
  };
  std::vector<double> by_moment(profile.size());
  for (std::size_t i = 1; i + 1 < profile.size(); ++i) {
    const double slope =
        (by_blur(i + 1) - by_blur(i - 1)) / (profile[i + 1].at - profile[i - 1].at);
    by_moment[i] = slope / std::sqrt(profile[i].variance);
  }
  return by_moment;
}

// One more parameter beside those of `normal`, which are eliminated (a Schur complement).
void measure_lopsidedness(const ScanProfile& profile, const FitEquations& normal,
                          const Eigen::LDLT<ParameterMatrix>& solver, double noise, double pixel,
                          SeenPlaces& seen) {
  const std::vector<double> by_moment = by_third_moment(profile, normal.places);
  double information = 0, right = 0;
  Parameters shared = Parameters::Zero();
  for (std::size_t i = 0; i < by_moment.size(); ++i) {
    information += by_moment[i] * by_moment[i];
    right += by_moment[i] * static_cast<double>(normal.places[i].residual);
    shared += by_moment[i] * normal.places[i].by_parameter.cast<double>();
  }
  const Parameters eliminated = solver.solve(shared);
  information -= shared.dot(eliminated);
  right -= normal.right.dot(eliminated);
  const double blur = std::exp(2 * normal.at[kLogBlur]);
  const double scale = 6 * blur / (blur + pixel * pixel / 12);
  seen.lopsided = -scale * right / information;
  seen.lopsided_sigma = scale * std::sqrt(noise / information);
}

}  // namespace

SymbolFit fit_symbol(const ScanProfile& profile, const Digits& digits, const ImagingModel& start) {
  const double variation = std::max(total_variation(profile), 1e-12);
  const FitEquations found =
      minimise(profile, digits, start, {.hopeless = (1 - kDecode.hopeless) * variation});
  return {unpack(found.solution, start.pixel), found.of_profile, 1 - found.of_profile / variation,
          found.solution[kLogBlur] >= most_log_blur()};
}

Eigen::RowVector3d SeenPlaces::by_displacement(double module) {
  const double from_middle = module - kModuleCount / 2.0;
  const double t = 2 * from_middle / kModuleCount;
  return {1, from_middle, t * t};
}

SeenPlaces seen_places(const ScanProfile& profile, const Digits& digits, const ImagingModel& start,
                       double bend_sigma) {
  static_assert(kStretch == kShift + 1 && kBend == kShift + 2);
  // A step that gains no more is a twentieth of a module at most, over which the bars' edges are as
  // good as straight.
  FitEquations normal = minimise(profile, digits, start, {.settled = 0.01});
  add_priors(normal.at - nominal_for(start), normal, -1);
  const double weight = 1 / (bend_sigma * bend_sigma);
  normal.matrix(kBend, kBend) += weight;
  normal.right[kBend] -= weight * normal.at[kBend];
  const auto solver = normal.matrix.ldlt();
  const Parameters p = normal.at + solver.solve(normal.right);
  const double freedom = std::max<double>(1, static_cast<double>(profile.size()) - kParameters);
  const ParameterMatrix inverse = solver.solve(ParameterMatrix::Identity());
  std::vector<float> residuals;
  for (const WeighedPlace& place : normal.places) residuals.push_back(place.residual);
  const double noise = normal.of_profile / freedom;
  SeenPlaces seen{p.segment<3>(kShift), noise * inverse.block<3, 3>(kShift, kShift),
                  std::move(residuals)};
  measure_lopsidedness(profile, normal, solver, noise, start.pixel, seen);
  return seen;
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
  NormalEquations normal = normal_equations(places);
  add_priors(Parameters::Zero(), normal);
  const Eigen::LLT<ParameterMatrix> root(normal.matrix);
  const Eigen::Matrix<float, kParameters, kParameters> inverse =
      root.matrixL().solve(ParameterMatrix::Identity()).cast<float>();
  NuisanceCovariance slack(places.size());
  for (std::size_t i = 0; i < slack.size(); ++i) {
    const auto sigma = static_cast<float>(std::sqrt(profile[i].variance));
    slack[i] = sigma * inverse.lazyProduct(places[i].by_parameter);
  }
  return slack;
}

}  // namespace tagsmith::detail
