// SPDX-License-Identifier: Apache-2.0
// Random numbers by position rather than by order, so that a simulated image is the same whatever
// the number of threads, the tiling, or the standard library.
#pragma once

#include <cstdint>

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

}  // namespace tagsmith::detail
