// SPDX-License-Identifier: Apache-2.0
// Values over a window that slides along a line of samples. A window reaches `window` samples to
// both sides, at the line's ends as far as there are samples.
#pragma once

#include <cstddef>
#include <vector>

namespace tagsmith::detail {

// The greatest and the least sample about each.
std::vector<float> running_maximum(const std::vector<float>& samples, std::size_t window);
std::vector<float> running_minimum(const std::vector<float>& samples, std::size_t window);

// The mean of the samples about each.
std::vector<float> running_mean(const std::vector<float>& samples, std::size_t window);

// Modules on either side of a place within which a symbol most likely shows its white and its
// black: two digits of 3, 6 or 7 beside the middle guard pattern have no space wider than one
// module, which blur darkens, for 24 modules. With 9 modules such pairs were read as 11.
inline constexpr int kWideElementsWithin = 16;

// A line's darkness between its local white and black: 0 and 1 where wide elements are near,
// `window` samples to both sides.
std::vector<float> local_darkness(const std::vector<float>& line, std::size_t window);

}  // namespace tagsmith::detail
