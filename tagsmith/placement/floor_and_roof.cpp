// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/floor_and_roof.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tagsmith {
namespace {

using Eigen::Vector3d;

// A ray strays farther than this from the center line only outside the tunnel.
double farthest_from_line(const Tunnel& tunnel) { return tunnel.width; }

double roof_above_floor(const Tunnel& tunnel, double /*chainage*/) { return tunnel.height; }

}  // namespace

FloorAndRoof::FloorAndRoof(const Tunnel& tunnel, double chainage, double reach)
    : greatest_offset_(farthest_from_line(tunnel)) {
  const Centerline& line = tunnel.centerline;
  double start = 0;
  double grade = line.elements().empty() ? 0 : line.elements().front().grade;
  for (const CenterlineElement& element : line.elements()) {
    if (element.grade != std::exchange(grade, element.grade) &&
        std::abs(start - chainage) <= reach) {
      const CenterlinePoint at = line.at(start);
      changes_.push_back(
          {at.position, direction_of(at.heading).head<2>(), roof_above_floor(tunnel, start)});
    }
    start += element.length;
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

}  // namespace tagsmith
