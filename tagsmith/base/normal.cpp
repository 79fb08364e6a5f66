// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/normal.hpp"

#include <cmath>
#include <numbers>

namespace tagsmith::detail {

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
