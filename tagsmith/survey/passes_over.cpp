// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/passes_over.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace tagsmith::detail {
namespace {

struct Step {
  Eigen::Vector3d position{0, 0, 0};
  double way = 0;  // seen from above, from the begin
  std::size_t corner = 0;
};

double length_of(const std::vector<Eigen::Vector3d>& way) {
  double length = 0;
  for (std::size_t i = 1; i < way.size(); ++i) length += (way[i] - way[i - 1]).head<2>().norm();
  return length;
}

// Points of the way that are `step` apart at most, and hardly nearer.
std::vector<Step> steps_along(const std::vector<Eigen::Vector3d>& way, double step) {
  std::vector<Step> steps{{way.front(), 0, 0}};
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Step last = steps.back();
    const Eigen::Vector3d along = way[i] - last.position;
    const double length = along.head<2>().norm();
    const auto count = static_cast<int>(length / step);
    for (int j = 1; j <= count; ++j) {
      const double share = static_cast<double>(j) / count;
      steps.push_back({last.position + share * along, last.way + share * length, i});
    }
  }
  return steps;
}

}  // namespace

std::optional<Passing> passing_of(const std::vector<Eigen::Vector3d>& way, double step, double room,
                                  double greatest_reach, const ReachBetween& reach_between) {
  constexpr double kMostSteps = 1e5;  // of longer ways only some places are compared
  if (way.empty() || !(step > 0)) return std::nullopt;
  const auto cell_of = [&](const Eigen::Vector3d& p) {
    return std::pair(static_cast<long>(std::floor(p.x() / greatest_reach)),
                     static_cast<long>(std::floor(p.y() / greatest_reach)));
  };
  const auto is_over = [&](const Step& later, const Step& earlier) {
    constexpr double kNarrowestTurn = 3;  // times the reach: the way round it
    const Eigen::Vector3d apart = later.position - earlier.position;
    const double distance = apart.head<2>().norm();
    if (distance >= greatest_reach || std::abs(apart.z()) <= room) return false;
    const double reach = reach_between(earlier.corner, later.corner);
    return distance < reach && later.way - earlier.way > kNarrowestTurn * reach;
  };
  std::map<std::pair<long, long>, std::vector<Step>> cells;
  for (const Step& later : steps_along(way, std::max(step, length_of(way) / kMostSteps))) {
    const auto [x, y] = cell_of(later.position);
    for (long i = x - 1; i <= x + 1; ++i) {
      for (long j = y - 1; j <= y + 1; ++j) {
        const auto cell = cells.find({i, j});
        if (cell == cells.end()) continue;
        for (const Step& earlier : cell->second) {
          if (!is_over(later, earlier)) continue;
          return Passing{earlier.corner, later.corner, later.position.z() - earlier.position.z()};
        }
      }
    }
    cells[{x, y}].push_back(later);
  }
  return std::nullopt;
}

}  // namespace tagsmith::detail
