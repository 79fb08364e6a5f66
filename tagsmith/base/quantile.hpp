// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tagsmith::detail {

// The value at place share * (n - 1), rounded down, of n sorted values: 0.5 = the median, of an
// even number the lower of the middle two. There must be at least one value; their order changes.
template <class Value>
Value quantile(std::vector<Value>& values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(
                                          share * static_cast<double>(values.size() - 1) + 1e-9);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace tagsmith::detail
