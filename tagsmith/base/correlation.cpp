// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/correlation.hpp"

#include <cstddef>

namespace tagsmith::detail {

double correlation_factor(std::span<const float> residuals) {
  double own = 0;
  for (const float residual : residuals) own += static_cast<double>(residual * residual);
  double factor = 1;
  for (std::size_t apart = 1; apart < residuals.size() && own > 0; ++apart) {
    double common = 0;
    for (std::size_t i = 0; i + apart < residuals.size(); ++i) {
      common += static_cast<double>(residuals[i] * residuals[i + apart]);
    }
    if (common <= 0) break;
    factor += 2 * common / own;
  }
  return factor;
}

}  // namespace tagsmith::detail
