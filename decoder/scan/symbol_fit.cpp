// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/symbol_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "tagsmith/base/normal.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

constexpr double kHalfLength = kModuleCount / 2.0;
constexpr int kEdgeCount = kElementCount + 1;

// Nominal places of the 60 edges; even ones begin a bar, odd ones end it.
std::array<double, kEdgeCount> edges_of(const Digits& digits) {
  std::array<double, kEdgeCount> edges{};
  double at = 0;
  std::size_t i = 0;
  for (const std::uint8_t width : elements_of(digits)) {
    edges[i++] = at;
    at += width;
  }
  edges[i] = at;
  return edges;
}

double displaced(const SymbolImage& image, double at) {
  const double t = (at - kHalfLength) / kHalfLength;
  return at + image.shift + image.stretch * (at - kHalfLength) + image.bend * t * t;
}

constexpr int kParameters = 8;
enum : int { kLogBlur, kShift, kStretch, kBend, kGrowth, kWhite, kBlack, kShading };
using Parameters = Eigen::Matrix<double, kParameters, 1>;

// Weak priors: standard deviations of the parameters about their nominal values. They hold what a
// short or empty profile leaves open, and forbid what would turn one digit into another.
constexpr std::array<double, kParameters> kPriorSigma{0.7, 0.5, 0.006, 0.3, 0.35, 0.3, 0.3, 0.2};

Parameters pack(const SymbolImage& image) {
  Parameters p;
  p << std::log(image.blur), image.shift, image.stretch, image.bend, image.growth, image.white,
      image.black, image.shading;
  return p;
}

SymbolImage unpack(const Parameters& p) {
  return {std::exp(p[kLogBlur]),
          p[kShift],
          p[kStretch],
          p[kBend],
          p[kGrowth],
          p[kWhite],
          p[kBlack],
          p[kShading]};
}

// The bars' share of the light at a place (0 in a wide space, 1 in a wide bar) and its derivatives
// by the edges' common movements.
struct BarShare {
  double share = 0;
  double by_log_blur = 0;
  double by_shift = 0;
  double by_stretch = 0;
  double by_bend = 0;
  double by_growth = 0;
};

class SymbolEdges {
 public:
  SymbolEdges(const SymbolImage& image, const Digits& digits)
      : nominal_(edges_of(digits)), blur_(image.blur) {
    for (std::size_t i = 0; i < nominal_.size(); ++i) {
      const double widening = (i % 2 == 0 ? -0.5 : 0.5) * image.growth;
      actual_[i] = displaced(image, nominal_[i]) + widening;
    }
  }

  // `first` is the least edge that can still matter; it only grows while places grow.
  BarShare at(double place, std::size_t& first) const {
    constexpr double kReach = 4.5;  // blurs; beyond, the step is flat to 1e-5
    while (first < actual_.size() && actual_[first] < place - kReach * blur_) ++first;
    BarShare bars;
    bars.share = first % 2 == 0 ? 0 : 1;
    for (std::size_t i = first; i < actual_.size() && actual_[i] < place + kReach * blur_; ++i) {
      const double z = (place - actual_[i]) / blur_;
      const double sign = i % 2 == 0 ? 1.0 : -1.0;
      const double density = normal_density(z);
      const double by_edge = -sign * density / blur_;
      const double t = (nominal_[i] - kHalfLength) / kHalfLength;
      bars.share += sign * normal_integral(z);
      bars.by_log_blur -= sign * density * z;
      bars.by_shift += by_edge;
      bars.by_stretch += by_edge * (nominal_[i] - kHalfLength);
      bars.by_bend += by_edge * t * t;
      bars.by_growth += by_edge * (i % 2 == 0 ? -0.5 : 0.5);
    }
    return bars;
  }

 private:
  std::array<double, kEdgeCount> nominal_;
  std::array<double, kEdgeCount> actual_{};
  double blur_;
};

struct NormalEquations {
  Eigen::Matrix<double, kParameters, kParameters> matrix =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Parameters right = Parameters::Zero();
  double cost = 0;        // of the profile alone
  double prior_cost = 0;  // of the parameters
};

NormalEquations accumulate(const ScanProfile& profile, const Digits& digits, const Parameters& p,
                           const Parameters& nominal) {
  const SymbolImage image = unpack(p);
  const SymbolEdges edges(image, digits);
  NormalEquations normal;
  std::size_t first = 0;
  for (const ScanBin& bin : profile) {
    const BarShare bars = edges.at(bin.at, first);
    const double contrast = image.black - image.white;
    const double t = (bin.at - kHalfLength) / kHalfLength;
    Parameters gradient;
    gradient << contrast * bars.by_log_blur, contrast * bars.by_shift, contrast * bars.by_stretch,
        contrast * bars.by_bend, contrast * bars.by_growth, 1 - bars.share, bars.share, t;
    const double expected = image.white + contrast * bars.share + image.shading * t;
    const double residual = bin.darkness - expected;
    normal.matrix.selfadjointView<Eigen::Lower>().rankUpdate(gradient, 1 / bin.variance);
    normal.right += residual / bin.variance * gradient;
    normal.cost += residual * residual / bin.variance;
  }
  for (int i = 0; i < kParameters; ++i) {
    const double sigma = kPriorSigma[static_cast<std::size_t>(i)];
    normal.matrix(i, i) += 1 / (sigma * sigma);
    normal.right[i] += (nominal[i] - p[i]) / (sigma * sigma);
    normal.prior_cost += (nominal[i] - p[i]) * (nominal[i] - p[i]) / (sigma * sigma);
  }
  return normal;
}

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

std::vector<double> expected_darkness(const SymbolImage& image, const Digits& digits,
                                      const ScanProfile& profile) {
  const SymbolEdges edges(image, digits);
  std::vector<double> expected;
  expected.reserve(profile.size());
  std::size_t first = 0;
  for (const ScanBin& bin : profile) {
    const double share = edges.at(bin.at, first).share;
    expected.push_back(image.white + (image.black - image.white) * share +
                       image.shading * (bin.at - kHalfLength) / kHalfLength);
  }
  return expected;
}

SymbolFit fit_symbol(const ScanProfile& profile, const Digits& digits, const SymbolImage& start) {
  constexpr int kMaxSteps = 12;
  SymbolImage nominal_image;
  nominal_image.blur = start.blur;
  const Parameters nominal = pack(nominal_image);
  Parameters p = pack(start);
  NormalEquations normal = accumulate(profile, digits, p, nominal);
  double damping = 1e-4;
  for (int step = 0; step < kMaxSteps; ++step) {
    Eigen::Matrix<double, kParameters, kParameters> matrix =
        normal.matrix.selfadjointView<Eigen::Lower>();
    matrix.diagonal() *= 1 + damping;
    Parameters next = p + matrix.ldlt().solve(normal.right);
    next[kLogBlur] = std::clamp(next[kLogBlur], std::log(0.05), std::log(4.0));
    NormalEquations tried = accumulate(profile, digits, next, nominal);
    const double before = normal.cost + normal.prior_cost;
    const double after = tried.cost + tried.prior_cost;
    if (!(after < before)) {
      damping *= 30;
      if (damping > 1e2) break;
      continue;
    }
    p = next;
    normal = tried;
    damping = std::max(1e-6, damping * 0.1);
    if (before - after < 1e-3 * after) break;
  }
  return {unpack(p), normal.cost, 1 - normal.cost / std::max(total_variation(profile), 1e-12), 1};
}

namespace {

// Sums over one stretch of a profile.
struct Share {
  double variation = 0;  // about mid grey
  double unexplained = 0;
  double noise = 0;  // what the variances allow of the latter

  void add(const ScanBin& bin, double expected, double middle) {
    const double residual = bin.darkness - expected;
    const double deviation = bin.darkness - middle;
    unexplained += residual * residual / bin.variance;
    variation += deviation * deviation / bin.variance;
    noise += 1;
  }
};

}  // namespace

double explained_by_guards(const ScanProfile& profile, const SymbolImage& image,
                           const Digits& digits) {
  // Each left digit starts with a space and ends with a bar, each right digit the reverse.
  constexpr std::array<std::array<double, 2>, 3> kKnown{{{-4, 4}, {44, 51}, {91, 99}}};
  const std::vector<double> expected = expected_darkness(image, digits, profile);
  const double middle = (image.white + image.black) / 2;
  Share share;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const double place = profile[i].at;
    const auto holds = [&](const auto& range) { return place >= range[0] && place <= range[1]; };
    if (!std::any_of(kKnown.begin(), kKnown.end(), holds)) continue;
    share.add(profile[i], expected[i], middle);
  }
  return share.variation > 0 ? 1 - share.unexplained / share.variation : 0;
}

double least_explained_digit(const ScanProfile& profile, const SymbolImage& image,
                             const Digits& digits) {
  const std::vector<double> expected = expected_darkness(image, digits, profile);
  const double middle = (image.white + image.black) / 2;
  std::array<Share, kDigitCount> shares{};
  for (std::size_t i = 0; i < profile.size(); ++i) {
    for (int digit = 0; digit < kDigitCount; ++digit) {
      const double first = first_module_of_digit(digit);
      if (profile[i].at < first || profile[i].at >= first + kModulesPerDigit) continue;
      shares[static_cast<std::size_t>(digit)].add(profile[i], expected[i], middle);
    }
  }
  double least = 1;
  for (const Share& share : shares) {
    if (share.variation <= 0) continue;
    const double unexplained = std::max(0.0, share.unexplained - share.noise);
    least = std::min(least, 1 - unexplained / share.variation);
  }
  return least;
}

}  // namespace tagsmith
