// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/correlation.hpp"

#include <cstddef>
#include <numeric>

namespace tagsmith::detail {

double correlation_factor(std::span<const float> residuals) {
  const auto common_at = [&](std::size_t apart) {
    const auto others = residuals.subspan(apart);
    return std::transform_reduce(others.begin(), others.end(), residuals.begin(), 0.0F);
  };
  const float own = common_at(0);
  float factor = 1;
  for (std::size_t apart = 1; apart < residuals.size() && own > 0; ++apart) {
    const float common = common_at(apart);
    if (common <= 0) break;
    factor += 2 * common / own;
  }
  return static_cast<double>(factor);
}

}  // namespace tagsmith::detail
