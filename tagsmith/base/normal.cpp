// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/normal.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace tagsmith {
namespace {

constexpr double kRange = 6;
constexpr int kStepsPerUnit = 512;
constexpr int kSize = static_cast<int>(2 * kRange) * kStepsPerUnit;

struct Tables {
  std::array<double, kSize + 2> integral{};
  std::array<double, kSize + 2> density{};

  Tables() {
    for (std::size_t i = 0; i < integral.size(); ++i) {
      const double z = static_cast<double>(i) / kStepsPerUnit - kRange;
      integral[i] = 0.5 * std::erfc(-z / std::numbers::sqrt2);
      density[i] = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
    }
  }
};

double look_up(const std::array<double, kSize + 2>& table, double z) {
  const double position = (z + kRange) * kStepsPerUnit;
  const auto index = static_cast<std::size_t>(position);
  return table[index] + (position - static_cast<double>(index)) * (table[index + 1] - table[index]);
}

const Tables& tables() {
  static const Tables kTables;
  return kTables;
}

}  // namespace

double normal_integral(double z) {
  if (z <= -kRange) return 0;
  if (z >= kRange) return 1;
  return look_up(tables().integral, z);
}

double normal_density(double z) {
  if (z <= -kRange || z >= kRange) return 0;
  return look_up(tables().density, z);
}

}  // namespace tagsmith
