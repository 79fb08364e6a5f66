// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace tagsmith::detail {

// The chi-square value that is exceeded with the probability that a normal value exceeds `z`
// (Wilson and Hilferty 1931).
inline double chi_square_limit(int degrees_of_freedom, double z) {
  const double n = degrees_of_freedom;
  return n * std::pow(1 - 2 / (9 * n) + z * std::sqrt(2 / (9 * n)), 3);
}

}  // namespace tagsmith::detail
