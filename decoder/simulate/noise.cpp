// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/noise.hpp"

#include <cmath>

namespace tagsmith::detail {
namespace {

// The finaliser of SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number
// generators", Fig 16 with the constants of variant 13).
constexpr std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

// Wichura 1988, "Algorithm AS 241: The percentage points of the normal distribution", PPND7.
double normal_quantile(double probability) {
  const double q = probability - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * (((59.109374720 * r + 159.29113202) * r + 50.434271938) * r + 3.3871327179) /
           (((67.187563600 * r + 78.757757664) * r + 17.895169469) * r + 1.0);
  }
  const double tail = q < 0 ? probability : 1.0 - probability;
  double r = std::sqrt(-std::log(tail));
  double magnitude = 0;
  if (r <= 5.0) {
    r -= 1.6;
    magnitude = (((0.17023821103 * r + 1.3067284816) * r + 2.7568153900) * r + 1.4234372777) /
                ((0.12021132975 * r + 0.73700164250) * r + 1.0);
  } else {
    r -= 5.0;
    magnitude = (((0.017337203997 * r + 0.42868294337) * r + 3.0812263860) * r + 6.6579051150) /
                ((0.012258202635 * r + 0.24197894225) * r + 1.0);
  }
  return q < 0 ? -magnitude : magnitude;
}

double lattice_noise(std::uint64_t seed, std::int64_t x, std::int64_t y) {
  const auto column = static_cast<std::uint64_t>(x) * 0xd6e8feb86659fd93ULL;
  const auto row = static_cast<std::uint64_t>(y) * 0xa0761d6478bd642fULL;
  return static_cast<double>(mix(seed ^ column ^ (row << 1U)) >> 40U) * 0x1p-24;
}

double ease(double t) { return t * t * (3.0 - 2.0 * t); }

}  // namespace

std::uint64_t random_bits(std::uint64_t seed, std::uint64_t counter) {
  return mix(mix(seed + kGolden) + (counter + 1) * kGolden);
}

double uniform_noise(std::uint64_t seed, std::uint64_t counter) {
  return (static_cast<double>(random_bits(seed, counter) >> 12U) + 0.5) * 0x1p-52;
}

double gaussian_noise(std::uint64_t seed, std::uint64_t counter) {
  return normal_quantile(uniform_noise(seed, counter));
}

double value_noise(std::uint64_t seed, double x, double y) { return ValueNoise(seed).at(x, y); }

double ValueNoise::at(double x, double y) {
  const double left = std::floor(x);
  const double top = std::floor(y);
  if (!(left == left_ && top == top_)) {
    const auto column = static_cast<std::int64_t>(left);
    const auto row = static_cast<std::int64_t>(top);
    corners_ = {lattice_noise(seed_, column, row), lattice_noise(seed_, column + 1, row),
                lattice_noise(seed_, column, row + 1), lattice_noise(seed_, column + 1, row + 1)};
    left_ = left;
    top_ = top;
  }
  const double u = ease(x - left);
  const double v = ease(y - top);
  const double upper = (1 - u) * corners_[0] + u * corners_[1];
  const double lower = (1 - u) * corners_[2] + u * corners_[3];
  return (1 - v) * upper + v * lower;
}

}  // namespace tagsmith::detail
