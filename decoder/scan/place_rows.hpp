// SPDX-License-Identifier: Apache-2.0
// Rows of costs by the place where a segment of a symbol may begin, and the loops over them that
// take most of an elastic scan's time.
#pragma once

#include <array>
#include <cstddef>

namespace tagsmith::detail {

inline constexpr std::size_t kPlaceCount = 51;
inline constexpr std::size_t kWidthCount = 9;  // local module widths

// Padded to whole vectors; what lies beyond kPlaceCount costs kFarCost.
inline constexpr std::size_t kPlaceLanes = 8;
inline constexpr std::size_t kPlaceRow =
    (kPlaceCount + kPlaceLanes - 1) / kPlaceLanes * kPlaceLanes;
inline constexpr float kFarCost = 1e9F;

using PlaceRow = std::array<float, kPlaceRow>;
using PlaceRows = std::array<PlaceRow, kWidthCount>;
using WidthPenalties = std::array<std::array<float, kWidthCount>, kWidthCount>;  // [from][to]

PlaceRows filled_rows(float cost);

// Sums of products of `count` template samples with the darkness, at every place: place i begins at
// darkness[i]. Reads count + kPlaceRow - 1 samples of darkness.
PlaceRow products(const float* darkness, const float* shown, std::size_t count);

// The lesser of both, place by place.
void take_less(const PlaceRow& costs, PlaceRow& least);

// least[from] = min over `to` of costs[to] + penalties[from][to], place by place.
PlaceRows least_onwards(const PlaceRows& costs, const WidthPenalties& penalties);

// The least of the sums of two rows.
float least_sum(const PlaceRow& a, const PlaceRow& b);

float least_of(const PlaceRows& rows);

}  // namespace tagsmith::detail
