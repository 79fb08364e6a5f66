// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace tagsmith::detail {

// At most so many of the values, evenly spread over them from the first on.
template <class Value>
std::vector<Value> evenly_taken(std::vector<Value> values, std::size_t most) {
  if (values.size() <= most) return values;
  std::vector<Value> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(values[i * values.size() / most]);
  return some;
}

}  // namespace tagsmith::detail
