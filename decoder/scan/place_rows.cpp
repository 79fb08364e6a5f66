// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/place_rows.hpp"

#include <algorithm>

#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
PlaceRows filled_rows(float cost) {
  PlaceRows rows;
  for (PlaceRow& row : rows) row.fill(cost);
  return rows;
}

TAGSMITH_WIDE PlaceRow products(const float* darkness, const float* shown, std::size_t count) {
  PlaceRow sums{};
  for (std::size_t i = 0; i < count; ++i) {
    const float factor = shown[i];
    for (std::size_t k = 0; k < kPlaceRow; ++k) sums[k] += darkness[i + k] * factor;
  }
  return sums;
}

TAGSMITH_WIDE void take_less(const PlaceRow& costs, PlaceRow& least) {
  for (std::size_t i = 0; i < kPlaceRow; ++i) {
    least[i] = costs[i] < least[i] ? costs[i] : least[i];
  }
}

TAGSMITH_WIDE PlaceRows least_onwards(const PlaceRows& costs, const WidthPenalties& penalties) {
  PlaceRows least = filled_rows(kFarCost);
  for (std::size_t from = 0; from < kWidthCount; ++from) {
    for (std::size_t to = 0; to < kWidthCount; ++to) {
      const float penalty = penalties[from][to];
      for (std::size_t i = 0; i < kPlaceRow; ++i) {
        const float cost = costs[to][i] + penalty;
        least[from][i] = cost < least[from][i] ? cost : least[from][i];
      }
    }
  }
  return least;
}

TAGSMITH_WIDE float least_sum(const PlaceRow& a, const PlaceRow& b) {
  std::array<float, kPlaceLanes> lanes;
  lanes.fill(kFarCost);
  for (std::size_t i = 0; i < kPlaceRow; i += kPlaceLanes) {
    for (std::size_t k = 0; k < kPlaceLanes; ++k) {
      const float sum = a[i + k] + b[i + k];
      lanes[k] = sum < lanes[k] ? sum : lanes[k];
    }
  }
  return *std::ranges::min_element(lanes);
}

float least_of(const PlaceRows& rows) {
  PlaceRow least = rows[0];
  for (const PlaceRow& row : rows) take_less(row, least);
  return *std::ranges::min_element(least);
}

}  // namespace tagsmith::detail
