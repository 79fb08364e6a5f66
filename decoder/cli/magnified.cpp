// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/magnified.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

// 1, 2 or 5 times a power of ten, the largest not above `value`; at least 1.
double round_factor(double value) {
  if (!(value > 1)) return 1;
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= value) return step * power;
  }
  return power;
}

}  // namespace

const double kEllipse95 = std::sqrt(-2 * std::log(0.05));

double magnification_for(const Tunnel& tunnel, std::vector<double> sizes) {
  if (sizes.empty()) return 1;
  const auto ninth = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() * 9 / 10);
  std::ranges::nth_element(sizes, ninth);
  constexpr double kMost = 1000;
  return *ninth > 0 ? std::min(kMost, round_factor(least_width(tunnel) / 5 / *ninth)) : 1;
}

Ellipse ellipse95(const Eigen::Vector2d& centre, const Eigen::Matrix2d& covariance, double factor) {
  const PrincipalAxes axes = principal_axes(covariance);
  const Eigen::Vector2d sigmas = axes.values.cwiseMax(0).cwiseSqrt();
  const Eigen::Vector2d first = axes.vectors.col(0);
  return {.at = centre,
          .semi_axes = factor * kEllipse95 * sigmas,
          .angle = std::atan2(first.y(), first.x()),
          .line = {colours::kBlue, kNarrow, {}}};
}

}  // namespace tagsmith::detail
