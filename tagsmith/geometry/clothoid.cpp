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

std::optional<Clothoid> clothoid_of(std::span<const CenterlineElement> arcs) {
  constexpr double kSame = 1e-6;  // metres
  if (arcs.empty() || arcs.front().clothoid == 0 || arcs.size() % 2 != 0) return std::nullopt;
  Clothoid clothoid;
  for (const CenterlineElement& arc : arcs) {
    if (std::abs(arc.length - arcs.front().length) > kSame) return std::nullopt;
    clothoid.length += arc.length;
  }
  const double by_pair = 1.5 * (arcs[1].curvature - arcs[0].curvature);  // from 1/6 to 5/6 of it
  const double change = by_pair * static_cast<double>(arcs.size()) / 2;
  const auto without_rounding = [&](double curvature) {
    return std::abs(curvature) < 1e-9 * std::abs(change) ? 0 : curvature;
  };
  clothoid.from = without_rounding(arcs[0].curvature - by_pair / 6);
  clothoid.to = without_rounding(clothoid.from + change);
  return clothoid;
}

std::span<const CenterlineElement> leading_part(std::span<const CenterlineElement> elements) {
  const auto of_other = std::ranges::find_if(elements, [&](const CenterlineElement& element) {
    return element.clothoid != elements.front().clothoid;
  });
  const auto arcs = elements.first(static_cast<std::size_t>(of_other - elements.begin()));
  return clothoid_of(arcs) ? arcs : elements.first(std::min<std::size_t>(1, elements.size()));
}

}  // namespace tagsmith::detail
