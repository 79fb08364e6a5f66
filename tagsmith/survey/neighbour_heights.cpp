// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/neighbour_heights.hpp"

#include <algorithm>
#include <utility>

#include "tagsmith/survey/expected_place.hpp"

namespace tagsmith::detail {
namespace {

// The height of the stations' line at a chainage.
double by_line(const std::vector<HeightStation>& stations, double chainage) {
  constexpr double kApart = 1e-3;
  std::vector<double> slopes;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    for (std::size_t j = i + 1; j < stations.size(); ++j) {
      const double run = stations[j].chainage - stations[i].chainage;
      if (run > kApart) slopes.push_back((stations[j].height - stations[i].height) / run);
    }
  }
  const double slope = slopes.empty() ? 0 : median(std::move(slopes));
  std::vector<double> heights;
  for (const HeightStation& station : stations) {
    heights.push_back(station.height + slope * (chainage - station.chainage));
  }
  return median(std::move(heights));
}

}  // namespace

std::vector<double> offs_from_neighbours(const std::vector<HeightStation>& stations) {
  if (stations.size() <= 2 * kNeighboursBeside) return {};
  std::vector<double> offs;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const std::size_t last = stations.size() - 1 - 2 * kNeighboursBeside;
    const std::size_t begin = std::min(i > kNeighboursBeside ? i - kNeighboursBeside : 0, last);
    std::vector<HeightStation> beside;
    for (std::size_t j = begin; j <= begin + 2 * kNeighboursBeside; ++j) {
      if (j != i) beside.push_back(stations[j]);
    }
    offs.push_back(stations[i].height - by_line(beside, stations[i].chainage));
  }
  return offs;
}

}  // namespace tagsmith::detail
