// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

namespace tagsmith {

// The values of a window that slides along a row, in order, so that any quantile is at hand.
template <class Value>
class SortedWindow {
 public:
  void clear() { values_.clear(); }
  bool empty() const { return values_.empty(); }

  void add(Value value) { values_.insert(values_.begin() + place_of(value), value); }
  // Takes out one that was added.
  void remove(Value value) {
    const std::ptrdiff_t place = place_of(value);
    if (place < std::ssize(values_)) values_.erase(values_.begin() + place);
  }

  // The value that this share of the others are not above; of a window that is not empty.
  Value quantile(double share) const {
    return values_[static_cast<std::size_t>(share * static_cast<double>(values_.size() - 1))];
  }

 private:
  // How many are less: counting a hundred has no branches to guess wrong.
  std::ptrdiff_t place_of(Value value) const {
    std::int32_t less = 0;
    for (const Value other : values_) less += other < value ? 1 : 0;
    return less;
  }

  std::vector<Value> values_;
};

}  // namespace tagsmith
