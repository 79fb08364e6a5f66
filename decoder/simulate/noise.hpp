// SPDX-License-Identifier: Apache-2.0
// Random numbers by position rather than by order, so that a simulated image is the same whatever
// the number of threads, the tiling, or the standard library.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace tagsmith::detail {

// 64 well mixed bits for the `counter`-th draw of a stream.
std::uint64_t random_bits(std::uint64_t seed, std::uint64_t counter);

// Uniform in (0, 1), never 0 or 1.
double uniform_noise(std::uint64_t seed, std::uint64_t counter);

// Standard normal, to 1e-7 of its quantile.
double gaussian_noise(std::uint64_t seed, std::uint64_t counter);

// Smooth noise in [0, 1] with features of about one unit: uniform at the points of the integer
// lattice, interpolated with zero slope there.
double value_noise(std::uint64_t seed, double x, double y);

// value_noise of one seed. Of places one after another it is the faster the fewer cells of the
// lattice they change.
class ValueNoise {
 public:
  explicit ValueNoise(std::uint64_t seed = 0) : seed_(seed) {}

  double at(double x, double y);

 private:
  std::uint64_t seed_;
  double left_ = std::numeric_limits<double>::quiet_NaN();  // of the cell whose corners are known
  double top_ = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 4> corners_{};  // upper left, upper right, lower left, lower right
};

}  // namespace tagsmith::detail
