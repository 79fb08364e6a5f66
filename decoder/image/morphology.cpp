// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/morphology.hpp"

#include <algorithm>
#include <deque>
#include <functional>

namespace tagsmith::detail {
namespace {

// Of each value's window the value that comes before all others by the order.
template <class Order>
std::vector<float> first_of_windows(std::span<const float> values, std::size_t reach, Order order) {
  std::vector<float> first(values.size());
  std::deque<std::size_t> candidates;  // places in the window, each before all that follow it
  std::size_t next = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (; next < std::min(values.size(), i + reach + 1); ++next) {
      while (!candidates.empty() && !order(values[candidates.back()], values[next])) {
        candidates.pop_back();
      }
      candidates.push_back(next);
    }
    while (candidates.front() + reach < i) candidates.pop_front();
    first[i] = values[candidates.front()];
  }
  return first;
}

}  // namespace

std::vector<float> closed(std::span<const float> values, std::size_t reach) {
  return first_of_windows(first_of_windows(values, reach, std::greater{}), reach, std::less{});
}

}  // namespace tagsmith::detail
