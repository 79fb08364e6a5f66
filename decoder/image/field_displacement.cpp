// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/field_displacement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tagsmith/base/statistics.hpp"
#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kMost = kMostFieldDisplacement;

// How much a row differs from the mean of its neighbours, displaced by -kMost to kMost
// pixels: sums of squares.
using Differences = std::array<std::int32_t, 2 * kMost + 1>;

TAGSMITH_WIDE
Differences differences_at(const GrayView& image, int y, int last) {
  const std::uint8_t *above = image.row(y - 1), *row = image.row(y), *below = image.row(y + 1);
  Differences sums{};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const int shift = static_cast<int>(i) - kMost;
    std::int32_t sum = 0;
    for (int x = kMost; x < last; ++x) {
      const auto difference =
          static_cast<std::int16_t>(2 * row[x] - above[x + shift] - below[x + shift]);
      sum += difference * difference;
    }
    sums[i] = sum;
  }
  return sums;
}

// The displacement at which an even and an odd row together differ least: each is displaced in the
// opposite direction. 0 where they show nothing that could be displaced.
double likeliest_displacement(const Differences& even, const Differences& odd) {
  std::array<double, 2 * kMost + 1> sums{};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i] = static_cast<double>(even[i]) + static_cast<double>(odd[sums.size() - 1 - i]);
  }
  const auto least = std::min_element(sums.begin() + 1, sums.end() - 1);
  const double bend = least[-1] - 2 * least[0] + least[1];
  if (!(bend > 0)) return 0;
  const double beside = (least[-1] - least[1]) / (2 * bend);
  return static_cast<double>(least - sums.begin()) - kMost + std::clamp(beside, -1.0, 1.0);
}

}  // namespace

double field_displacement(const GrayView& image) {
  constexpr int kPairs = 8;            // of rows, from top to bottom
  constexpr int kMostColumns = 8'000;  // the sums of their squares fit
  constexpr double kLeast = 0.1;       // pixels; single exposures show up to 0.03
  const int last = std::min(image.width - kMost, kMostColumns);
  const int step = image.height / (4 * kPairs) * 2 + 1;  // odd
  std::vector<double> displacements;
  for (int y = 2; y + step < image.height - 1; y += 2 * step) {
    displacements.push_back(likeliest_displacement(differences_at(image, y, last),
                                                   differences_at(image, y + step, last)));
  }
  if (displacements.size() < 4) return 0;
  // Three in four pairs of rows must agree.
  const bool is_clear =
      quantile(displacements, 0.25) > kLeast || quantile(displacements, 0.75) < -kLeast;
  return is_clear ? std::abs(quantile(displacements, 0.5)) : 0;
}

}  // namespace tagsmith::detail
