// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/magnified.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/render/drawing_title.hpp"

namespace tagsmith::detail {

const double kEllipse95 = std::sqrt(-2 * std::log(0.05));

double magnification_for(const Tunnel& tunnel, std::vector<double> sizes) {
  if (sizes.empty()) return 1;
  const auto ninth = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() * 9 / 10);
  std::ranges::nth_element(sizes, ninth);
  if (!(*ninth > 0)) return 1;
  // What divides the size into a fifth of the tunnel is rounded up, so that the factor, which is as
  // round, is rounded down.
  return std::clamp(1 / round_step(*ninth / (least_width(tunnel) / 5)), 1.0, 1000.0);
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
