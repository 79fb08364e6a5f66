// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tagsmith::detail {

// The value that `share` (0-1) of the others are not above, of values that are not none; 0.5 is
// the median, the lower one of an even number's two. Changes their order.
template <class Value>
Value quantile(std::vector<Value>& values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(
                                          share * static_cast<double>(values.size() - 1) + 1e-9);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace tagsmith::detail
