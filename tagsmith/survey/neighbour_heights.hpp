// SPDX-License-Identifier: Apache-2.0
// Heights along a drive against those of their neighbours. Internal to tagsmith/survey.
#pragma once

#include <cstddef>
#include <vector>

namespace tagsmith::detail {

inline constexpr std::size_t kNeighboursBeside = 3;  // on either side, as far as there are any

struct HeightStation {
  double chainage = 0;  // metres, as all
  double height = 0;
  std::size_t index = 0;  // of the point
};

// How far each station lies above the line (Theil and Sen: the median slope of all pairs) through
// its six neighbours, of which one or two may be wrong; at the ends that line is prolonged.
// `stations` are in the order of their chainages. Nothing for fewer than seven.
std::vector<double> offs_from_neighbours(const std::vector<HeightStation>& stations);

}  // namespace tagsmith::detail
