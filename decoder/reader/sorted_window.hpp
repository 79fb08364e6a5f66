// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tagsmith {

// The values of a window that slides along a row, in order, so that any quantile is at hand.
template <class Value>
class SortedWindow {
 public:
  void clear() { values_.clear(); }
  bool empty() const { return values_.empty(); }

  void add(Value value) { values_.insert(std::ranges::upper_bound(values_, value), value); }
  // Takes out one that was added.
  void remove(Value value) {
    const auto at = std::ranges::lower_bound(values_, value);
    if (at != values_.end()) values_.erase(at);
  }

  // The value that this share of the others are not above; of a window that is not empty.
  Value quantile(double share) const {
    return values_[static_cast<std::size_t>(share * static_cast<double>(values_.size() - 1))];
  }

 private:
  std::vector<Value> values_;
};

}  // namespace tagsmith
