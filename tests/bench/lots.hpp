// SPDX-License-Identifier: Apache-2.0
// Random draws of the benches' pictures.
#pragma once

#include <cmath>
#include <random>

namespace tagsmith::detail::mass {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline bool chance(Random& random, double probability) {
  return uniform(random, 0, 1) < probability;
}

inline int integer(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

inline double log_uniform(Random& random, double low, double high) {
  return std::exp(uniform(random, std::log(low), std::log(high)));
}

}  // namespace tagsmith::detail::mass
