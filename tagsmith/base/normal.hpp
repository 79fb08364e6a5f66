// SPDX-License-Identifier: Apache-2.0
// The standard normal distribution, from a table: the decoder needs millions of values.
#pragma once

#include <array>
#include <cstddef>

namespace tagsmith::detail {

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
