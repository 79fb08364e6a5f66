// SPDX-License-Identifier: Apache-2.0
// Statistics of samples: quantiles, limits and tables of distributions, correlated residuals.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace tagsmith::detail {

// ---- Samples.

// The place of a quantile among so many sorted values, at least one.
inline std::size_t quantile_place(std::size_t count, double share) {
  return static_cast<std::size_t>(share * static_cast<double>(count - 1) + 1e-9);
}

// The value at place share * (n - 1), rounded down, of n sorted values: 0.5 = the median, of an
// even number the lower of the middle two. There must be at least one value; their order changes.
template <class Value>
Value quantile(std::vector<Value>& values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(quantile_place(values.size(), share));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

// At most so many of the values, evenly spread over them from the first on.
template <class Value>
std::vector<Value> evenly_taken(std::vector<Value> values, std::size_t most) {
  if (values.size() <= most) return values;
  std::vector<Value> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(values[i * values.size() / most]);
  return some;
}

// The factor by which correlation of neighbouring residuals raises a fit's variance: from their
// correlation up to the first distance at which there is none. 1 for independent ones.
double correlation_factor(std::span<const float> residuals);

// ---- Distributions.

// The chi-square value that is exceeded with the probability that a normal value exceeds `z`
// (Wilson and Hilferty 1931).
inline double chi_square_limit(int degrees_of_freedom, double z) {
  const double n = degrees_of_freedom;
  return n * std::pow(1 - 2 / (9 * n) + z * std::sqrt(2 / (9 * n)), 3);
}

// Integral of the density up to z (to 2e-6), and the density itself (to 4e-6).
struct NormalValue {
  float integral = 0;
  float density = 0;
};

class NormalTable {
 public:
  static const NormalTable& get();

  NormalValue operator()(float z) const {
    if (z <= -kRange) return {0, 0};
    if (!(z < kRange)) return {1, 0};
    const float position = (z + kRange) * kStepsPerUnit;
    const int index = static_cast<int>(position);
    const float t = position - static_cast<float>(index);
    const NormalValue& a = values_[static_cast<std::size_t>(index)];
    const NormalValue& b = values_[static_cast<std::size_t>(index) + 1];
    return {a.integral + t * (b.integral - a.integral), a.density + t * (b.density - a.density)};
  }

 private:
  NormalTable();
  static constexpr float kRange = 6;
  static constexpr int kStepsPerUnit = 128;
  static constexpr int kSize = static_cast<int>(2 * kRange) * kStepsPerUnit;
  std::array<NormalValue, kSize + 2> values_{};
};

// Standard deviations that noise does not reach.
inline constexpr double kBeyondNoise = 4;

}  // namespace tagsmith::detail
