// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail::bench {

// The median of what a table's cell holds, the upper one of an even number's two; 0 of nothing.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// The value that `share` (0-1) of the others are not above, the lower of two; 0 of nothing.
inline double quantile(std::vector<double> values, double share) {
  return values.empty() ? 0 : tagsmith::detail::quantile(values, share);
}

}  // namespace tagsmith::detail::bench
