// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/floor_and_roof.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

// Chainages within `reach` of one, where floor or roof do not go on as before.
// Why: docs/decisions/0014-walls-and-grade.md.
std::vector<double> breaks_of(const Tunnel& tunnel, double chainage, double reach) {
  std::vector<double> breaks = tunnel.height.is_constant()
                                   ? std::vector<double>{}
                                   : tunnel.height.breaks(chainage - reach, chainage + reach);
  const auto& elements = tunnel.centerline.elements();
  double start = 0;
  double grade = elements.empty() ? 0 : elements.front().grade;
  for (const CenterlineElement& element : elements) {
    const bool changes = element.grade != std::exchange(grade, element.grade);
    if (changes && std::abs(start - chainage) <= reach) breaks.push_back(start);
    start += element.length;
  }
  return breaks;
}

}  // namespace

FloorAndRoof::FloorAndRoof(const Tunnel& tunnel, double chainage, double reach)
    : greatest_offset_(greatest_width(tunnel)) {
  for (const double where : breaks_of(tunnel, chainage, reach)) {
    const CenterlinePoint at = tunnel.centerline.at(where);
    changes_.push_back({at.position, direction_of(at.heading).head<2>(),
                        std::min(tunnel.height.before(where), tunnel.height.at(where))});
  }
}

std::optional<FloorAndRoof::Crossing> FloorAndRoof::crossing(const Change& change,
                                                             const Vector3d& origin,
                                                             const Vector3d& direction,
                                                             double way) const {
  const double along = direction.head<2>().dot(change.along);
  if (along == 0) return std::nullopt;
  const double there = (change.place - origin).head<2>().dot(change.along) / along;
  if (!(there > 0) || there >= way) return std::nullopt;
  const Vector3d from_place = origin + there * direction - change.place;
  if (from_place.head<2>().norm() > greatest_offset_) return std::nullopt;  // round a bend
  return Crossing{there, from_place.z() < 0, from_place.z() > change.roof_above_floor};
}

std::optional<RoomExit> FloorAndRoof::first_exit(const Vector3d& origin, const Vector3d& direction,
                                                 double way) const {
  std::optional<RoomExit> exit;
  for (const Change& change : changes_) {
    const auto there = crossing(change, origin, direction, exit ? exit->first_outside : way);
    if (there && (there->below || there->above)) exit = RoomExit{0, there->way, there->below};
  }
  for (const Change& change : changes_) {
    if (!exit) break;
    const auto there = crossing(change, origin, direction, exit->first_outside);
    if (there) exit->last_inside = std::max(exit->last_inside, there->way);
  }
  return exit;
}

}  // namespace tagsmith::detail
