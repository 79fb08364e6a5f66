// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

namespace tagsmith::detail {
namespace {

TEST_CASE("Gaussian noise follows the normal distribution") {
  constexpr int kCount = 200000;
  std::vector<double> draws;
  for (int i = 0; i < kCount; ++i) {
    draws.push_back(gaussian_noise(42, static_cast<std::uint64_t>(i)));
  }
  std::ranges::sort(draws);
  // Kolmogorov's statistic: 1.63 / sqrt(n) at one in a hundred.
  double largest = 0;
  for (int i = 0; i < kCount; ++i) {
    const double cumulative =
        0.5 * std::erfc(-draws[static_cast<std::size_t>(i)] / std::numbers::sqrt2);
    largest = std::max(largest, std::abs(cumulative - (i + 0.5) / kCount));
  }
  CHECK(largest < 1.63 / std::sqrt(kCount));
  CHECK(draws.front() < -4);
  CHECK(draws.back() > 4);
}

TEST_CASE("Neighbouring draws and neighbouring seeds are uncorrelated") {
  constexpr int kCount = 100000;
  double along = 0;
  double across = 0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    along += gaussian_noise(1, i) * gaussian_noise(1, i + 1);
    across += gaussian_noise(1, i) * gaussian_noise(2, i);
  }
  CHECK(std::abs(along / kCount) < 4 / std::sqrt(kCount));
  CHECK(std::abs(across / kCount) < 4 / std::sqrt(kCount));
}

TEST_CASE("A draw depends on seed and counter alone") {
  const double first = gaussian_noise(3, 1000);
  gaussian_noise(3, 5);
  CHECK(gaussian_noise(3, 1000) == first);
  CHECK(gaussian_noise(4, 1000) != first);
}

TEST_CASE("Value noise of places one after another is that of each alone") {
  ValueNoise noise(5);
  for (std::uint64_t i = 0; i < 400; ++i) {
    const double x = 6 * uniform_noise(1, i / 3) - 3, y = 4 * uniform_noise(2, i / 2) - 2;
    CHECK(noise.at(x, y) == value_noise(5, x, y));
  }
}

TEST_CASE("Value noise is continuous, within 0 and 1, and not constant") {
  double low = 1;
  double high = 0;
  double before = value_noise(5, -3.0, 0.37);
  for (int i = 1; i < 6000; ++i) {
    const double value = value_noise(5, -3.0 + 0.001 * i, 0.37);
    CHECK(std::abs(value - before) < 0.01);
    low = std::min(low, value);
    high = std::max(high, value);
    before = value;
  }
  CHECK(low >= 0);
  CHECK(high <= 1);
  CHECK(high - low > 0.3);
}

}  // namespace
}  // namespace tagsmith::detail
