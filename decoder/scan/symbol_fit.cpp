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

constexpr float kHalfLength = kModuleCount / 2.0F;
constexpr int kEdgeCount = kElementCount + 1;

// Nominal places of the 60 edges; even ones begin a bar, odd ones end it.
std::array<float, kEdgeCount> edges_of(const Digits& digits) {
  std::array<float, kEdgeCount> edges{};
  int at = 0;
  std::size_t i = 0;
  for (const std::uint8_t width : elements_of(digits)) {
    edges[i++] = static_cast<float>(at);
    at += width;
  }
  edges[i] = static_cast<float>(at);
  return edges;
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
  float share = 0;
  float by_log_blur = 0;
  float by_shift = 0;
  float by_stretch = 0;
  float by_bend = 0;
  float by_growth = 0;
};

class SymbolEdges {
 public:
  SymbolEdges(const SymbolImage& image, const Digits& digits)
      : blur_(static_cast<float>(image.blur)) {
    const std::array<float, kEdgeCount> nominal = edges_of(digits);
    for (std::size_t i = 0; i < nominal.size(); ++i) {
      const float from_middle = nominal[i] - kHalfLength;
      const float t = from_middle / kHalfLength;
      const float widening = (i % 2 == 0 ? -0.5F : 0.5F) * static_cast<float>(image.growth);
      from_middle_[i] = from_middle;
      bend_[i] = t * t;
      actual_[i] = nominal[i] + static_cast<float>(image.shift) +
                   static_cast<float>(image.stretch) * from_middle +
                   static_cast<float>(image.bend) * bend_[i] + widening;
    }
  }

  // `first` is the least edge that can still matter; it only grows while places grow.
  float share_at(const ScanBin& bin, std::size_t& first) const {
    const auto [place, per_blur, reach] = spread_at(bin);
    while (first < actual_.size() && actual_[first] < place - reach) ++first;
    float share = first % 2 == 0 ? 0 : 1;
    for (std::size_t i = first; i < actual_.size() && actual_[i] < place + reach; ++i) {
      const float integral = normal_((place - actual_[i]) * per_blur).integral;
      share += i % 2 == 0 ? integral : -integral;
    }
    return share;
  }

  // With derivatives.
  BarShare at(const ScanBin& bin, std::size_t& first) const {
    const auto [place, per_blur, reach] = spread_at(bin);
    while (first < actual_.size() && actual_[first] < place - reach) ++first;
    BarShare bars;
    bars.share = first % 2 == 0 ? 0 : 1;
    for (std::size_t i = first; i < actual_.size() && actual_[i] < place + reach; ++i) {
      const float z = (place - actual_[i]) * per_blur;
      const NormalValue value = normal_(z);
      const float sign = i % 2 == 0 ? 1.0F : -1.0F;
      const float density = sign * value.density;
      const float by_edge = -density * per_blur;
      bars.share += sign * value.integral;
      bars.by_log_blur -= density * z;
      bars.by_shift += by_edge;
      bars.by_stretch += by_edge * from_middle_[i];
      bars.by_bend += by_edge * bend_[i];
      bars.by_growth -= 0.5F * sign * by_edge;
    }
    return bars;
  }

 private:
  struct Spread {
    float place;
    float per_blur;  // one over the standard deviation of the point spread, 1/modules
    float reach;     // of an edge, modules
  };

  Spread spread_at(const ScanBin& bin) const {
    constexpr float kReach = 4.5F;  // blurs; beyond, the step is flat to 1e-5
    const float blur = blur_ * static_cast<float>(bin.spread);
    return {static_cast<float>(bin.at), 1 / blur, kReach * blur};
  }

  const NormalTable& normal_ = NormalTable::get();
  std::array<float, kEdgeCount> from_middle_{};
  std::array<float, kEdgeCount> bend_{};
  std::array<float, kEdgeCount> actual_{};
  float blur_;
};

struct NormalEquations {
  Eigen::Matrix<double, kParameters, kParameters> matrix =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Parameters right = Parameters::Zero();
  double cost = 0;        // of the profile alone
  double prior_cost = 0;  // of the parameters
};

// The normal equations of a profile for given digits; keeps its memory from step to step.
class FitProblem {
 public:
  FitProblem(const ScanProfile& profile, const Digits& digits, const Parameters& nominal)
      : profile_(profile), digits_(digits), nominal_(nominal) {
    rows_.resize(static_cast<Eigen::Index>(profile.size()), kParameters + 1);
    root_weights_.reserve(profile.size());
    for (const ScanBin& bin : profile) {
      root_weights_.push_back(1 / std::sqrt(static_cast<float>(bin.variance)));
    }
  }

  // Derivatives of the darkness by the parameters, over the places' standard deviations.
  auto derivatives() const { return rows_.leftCols<kParameters>(); }

  NormalEquations at(const Parameters& p) {
    fill_rows(unpack(p));
    const Eigen::Matrix<float, kParameters + 1, kParameters + 1> product =
        rows_.transpose() * rows_;
    NormalEquations normal;
    normal.matrix = product.topLeftCorner<kParameters, kParameters>().cast<double>();
    normal.right = product.topRightCorner<kParameters, 1>().cast<double>();
    normal.cost = static_cast<double>(product(kParameters, kParameters));
    for (int i = 0; i < kParameters; ++i) {
      const double sigma = kPriorSigma[static_cast<std::size_t>(i)];
      const double off = nominal_[i] - p[i];
      normal.matrix(i, i) += 1 / (sigma * sigma);
      normal.right[i] += off / (sigma * sigma);
      normal.prior_cost += off * off / (sigma * sigma);
    }
    return normal;
  }

 private:
  // One row a place: the gradient and the residual, in standard deviations.
  void fill_rows(const SymbolImage& image) {
    const SymbolEdges edges(image, digits_);
    const float white = static_cast<float>(image.white);
    const float contrast = static_cast<float>(image.black - image.white);
    const float shading = static_cast<float>(image.shading);
    std::size_t first = 0;
    for (std::size_t i = 0; i < profile_.size(); ++i) {
      const float place = static_cast<float>(profile_[i].at);
      const BarShare bars = edges.at(profile_[i], first);
      const float t = (place - kHalfLength) / kHalfLength;
      const float weight = root_weights_[i];
      const float scale = contrast * weight;
      const auto row = static_cast<Eigen::Index>(i);
      rows_(row, kLogBlur) = scale * bars.by_log_blur;
      rows_(row, kShift) = scale * bars.by_shift;
      rows_(row, kStretch) = scale * bars.by_stretch;
      rows_(row, kBend) = scale * bars.by_bend;
      rows_(row, kGrowth) = scale * bars.by_growth;
      rows_(row, kWhite) = weight * (1 - bars.share);
      rows_(row, kBlack) = weight * bars.share;
      rows_(row, kShading) = weight * t;
      const float expected = white + contrast * bars.share + shading * t;
      rows_(row, kParameters) = weight * (static_cast<float>(profile_[i].darkness) - expected);
    }
  }

  const ScanProfile& profile_;
  const Digits& digits_;
  Parameters nominal_;
  std::vector<float> root_weights_;
  Eigen::Matrix<float, Eigen::Dynamic, kParameters + 1> rows_;
};

// As SymbolEdges::share_at, with levels and shading.
double darkness_at(const SymbolImage& image, const SymbolEdges& edges, const ScanBin& bin,
                   std::size_t& first) {
  const auto share = static_cast<double>(edges.share_at(bin, first));
  return image.white + (image.black - image.white) * share +
         image.shading * (2 * bin.at / kModuleCount - 1);
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
    expected.push_back(darkness_at(image, edges, bin, first));
  }
  return expected;
}

SymbolFit fit_symbol(const ScanProfile& profile, const Digits& digits, const SymbolImage& start) {
  constexpr int kMaxSteps = 12;
  SymbolImage nominal_image;
  nominal_image.blur = start.blur;
  const Parameters nominal = pack(nominal_image);
  Parameters p = pack(start);
  FitProblem problem(profile, digits, nominal);
  NormalEquations normal = problem.at(p);
  double damping = 1e-4;
  for (int step = 0; step < kMaxSteps; ++step) {
    Eigen::Matrix<double, kParameters, kParameters> matrix = normal.matrix;
    matrix.diagonal() *= 1 + damping;
    Parameters next = p + matrix.ldlt().solve(normal.right);
    next[kLogBlur] = std::clamp(next[kLogBlur], std::log(0.05), std::log(4.0));
    const NormalEquations tried = problem.at(next);
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

FitSlack slack_of_fit(const ScanProfile& profile, const SymbolImage& image, const Digits& digits) {
  const Parameters p = pack(image);
  FitProblem problem(profile, digits, p);
  const NormalEquations normal = problem.at(p);
  // With matrix = L L^T, the parameters' covariance is L^-T L^-1.
  const Eigen::LLT<Eigen::Matrix<double, kParameters, kParameters>> root(normal.matrix);
  const Eigen::Matrix<double, kParameters, Eigen::Dynamic> deviations =
      root.matrixL().solve(problem.derivatives().transpose().cast<double>());
  FitSlack slack(profile.size());
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const double sigma = std::sqrt(profile[i].variance);
    for (int k = 0; k < kParameters; ++k) {
      slack[i][static_cast<std::size_t>(k)] =
          static_cast<float>(sigma * deviations(k, static_cast<Eigen::Index>(i)));
    }
  }
  return slack;
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
  const SymbolEdges edges(image, digits);
  const double middle = (image.white + image.black) / 2;
  Share share;
  std::size_t first = 0;
  for (const ScanBin& bin : profile) {
    const auto holds = [&](const auto& range) { return bin.at >= range[0] && bin.at <= range[1]; };
    if (!std::any_of(kKnown.begin(), kKnown.end(), holds)) continue;
    share.add(bin, darkness_at(image, edges, bin, first), middle);
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
