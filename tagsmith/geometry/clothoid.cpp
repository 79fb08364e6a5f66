// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/clothoid.hpp"

#include <algorithm>
#include <cmath>

namespace tagsmith::detail {

std::vector<CenterlineElement> arcs_of_clothoid(double length, double from, double to, int number) {
  // Between its arcs a pair is off by about change * span^3 / 150.
  constexpr double kMostOff = 2e-5;  // metres
  constexpr double kMostPairs = 500;
  const double change = std::abs(to - from) / length;
  const double pairs =
      std::clamp(std::ceil(length * std::cbrt(change / (150 * kMostOff))), 1.0, kMostPairs);
  std::vector<CenterlineElement> arcs;
  for (int i = 0; i < static_cast<int>(pairs); ++i) {
    // Two arcs of half the span have the span's turn and its way aside when their curvatures are
    // those at a sixth and at five sixths of it.
    for (const double share : {1.0 / 6, 5.0 / 6}) {
      const double curvature = from + (to - from) * (i + share) / pairs;
      arcs.push_back({length / (2 * pairs), curvature, 0, number});
    }
  }
  return arcs;
}

}  // namespace tagsmith::detail
