// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/statistics.hpp"

#include <numbers>
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

NormalTable::NormalTable() {
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const double z = static_cast<double>(i) / kStepsPerUnit - static_cast<double>(kRange);
    values_[i] = {static_cast<float>(0.5 * std::erfc(-z / std::numbers::sqrt2)),
                  static_cast<float>(std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi))};
  }
}

const NormalTable& NormalTable::get() {
  static const NormalTable kTable;
  return kTable;
}

}  // namespace tagsmith::detail
