// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/tunnel_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tagsmith/geometry/side_line.hpp"

namespace tagsmith::detail {

// ---- Walls.

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kJoint = 1e-6;  // metres by which neighbouring pieces overlap

}  // namespace

TunnelWalls::TunnelWalls(const Tunnel& tunnel, double standoff, double chainage, double reach) {
  const double first = chainage - reach;
  const double last = chainage + reach;
  const double behind = std::max(standoff, tunnel.stand_off);
  for (const Side side : {Side::left, Side::right}) {
    const ChainageProfile offset =
        wall_of(tunnel, side).scaled(1, side == Side::left ? -behind : behind);
    if (offset.is_constant()) {
      add_parallel(tunnel.centerline, side, offset.at(0), first, last);
    } else {
      add_pieces(tunnel.centerline, side, offset, first, last);
    }
  }
}

void TunnelWalls::add_parallel(const Centerline& line, Side side, double offset, double first,
                               double last) {
  if (first < 0) add(line.at(first), 0, -first, first, side, offset);
  double start = 0;
  for (const CenterlineElement& element : line.elements()) {
    if (start + element.length >= first && start <= last) {
      add(line.at(start), element.curvature, element.length, start, side, offset);
    }
    start += element.length;
  }
  if (last > line.length()) {
    add(line.at(line.length()), 0, last - line.length(), line.length(), side, offset);
  }
}

void TunnelWalls::add(const CenterlinePoint& start, double curvature, double length,
                      double chainage, Side side, double offset) {
  const Vector2d along = direction_of(start.heading).head<2>();
  const Vector2d across = right_of(start.heading).head<2>();
  const Vector2d on_wall = start.position.head<2>() + offset * across;
  if (curvature == 0) {
    straights_.push_back({on_wall, along, across, length, chainage, 1, side});
    return;
  }
  const Vector2d centre = start.position.head<2>() + across / curvature;
  // Left of a left turn's centre there is no wall.
  if ((1.0 / curvature - offset) * curvature <= 0) return;
  const Vector2d from_centre = on_wall - centre;
  arcs_.push_back(
      {centre, from_centre.normalized(), from_centre.norm(), curvature, length, chainage, side});
}

void TunnelWalls::add_pieces(const Centerline& line, Side side, const ChainageProfile& offset,
                             double first, double last) {
  constexpr double kSag = 0.002;  // metres by which straight pieces miss a curved wall
  const std::vector<SidePoint> points = side_points(line, offset, first, last, kSag);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector2d from = points[i - 1].position.head<2>();
    const Vector2d way = points[i].position.head<2>() - from;
    const double length = way.norm();
    if (length < kJoint) continue;
    const Vector2d along = way / length;
    const double chainages = points[i].chainage - points[i - 1].chainage;
    straights_.push_back({from, along, Vector2d(along.y(), -along.x()), length,
                          points[i - 1].chainage, chainages / length, side});
  }
}

void TunnelWalls::meet(const Straight& wall, const Vector2d& origin, const Vector2d& direction,
                       std::optional<WallHit>& nearest) {
  const double towards = direction.dot(wall.across);
  if (towards == 0) return;
  const double way = (wall.start - origin).dot(wall.across) / towards;
  if (!(way > 0) || (nearest && way >= nearest->way)) return;
  const double along = (origin + way * direction - wall.start).dot(wall.along);
  if (along < -kJoint || along > wall.length + kJoint) return;
  nearest = WallHit{way, wall.chainage + wall.stretch * along, wall.side,
                    std::abs(towards) / direction.norm()};
}

void TunnelWalls::meet(const Arc& wall, const Vector2d& origin, const Vector2d& direction,
                       std::optional<WallHit>& nearest) {
  const Vector2d from_centre = origin - wall.centre;
  const double a = direction.squaredNorm();
  const double b = direction.dot(from_centre);
  const double c = from_centre.squaredNorm() - wall.radius * wall.radius;
  const double discriminant = b * b - a * c;
  if (discriminant < 0 || a == 0) return;
  const double root = std::sqrt(discriminant);
  for (const double way : {(-b - root) / a, (-b + root) / a}) {
    if (!(way > 0) || (nearest && way >= nearest->way)) continue;
    const Vector2d normal = (from_centre + way * direction) / wall.radius;
    // Angles grow clockwise where the tunnel turns right.
    const double turned = std::atan2(cross(wall.from_centre, normal), wall.from_centre.dot(normal));
    double along = -turned / wall.curvature;
    const double circle = 2 * std::numbers::pi / std::abs(wall.curvature);
    if (along < -kJoint) along += circle;
    if (along > wall.length + kJoint) continue;
    nearest = WallHit{way, wall.chainage + along, wall.side,
                      std::abs(direction.dot(normal)) / direction.norm()};
  }
}

std::optional<WallHit> TunnelWalls::first_hit(const Vector2d& origin,
                                              const Vector2d& direction) const {
  std::optional<WallHit> nearest;
  for (const Straight& wall : straights_) meet(wall, origin, direction, nearest);
  for (const Arc& wall : arcs_) meet(wall, origin, direction, nearest);
  return nearest;
}

double wall_standoff(const Survey& survey, double chainage, double reach) {
  const TagTemplate& tag = survey.tag_template;
  const double left = (tag.frame_inner_length - tag.plate_length) / 2 - tag.frame_offset_right;
  double farthest = 0;
  for (const PlacedTag& placed : survey.tags) {
    if (std::abs(placed.chainage - chainage) > reach) continue;
    for (const double x : {left, left + tag.plate_length}) {
      const Vector3d corner = placed.world_from_plate * Vector3d(x, 0, 0);
      const CenterlineAddress address = survey.tunnel.centerline.locate(corner.head<2>());
      farthest = std::max(farthest, behind_wall(survey.tunnel, placed.side, address));
    }
  }
  return standoff_behind(farthest);
}

double standoff_behind(double farthest) {
  constexpr double kGap = 0.010;
  constexpr double kMost = 0.5;
  return std::min(std::max(farthest, 0.0) + kGap, kMost);
}

// ---- Floor and roof.

namespace {

// Chainages within `reach` of one, where floor or roof do not continue as before.
// Why: docs/decisions/0001-frames-grids-and-walls.md.
std::vector<double> breaks_of(const Tunnel& tunnel, double chainage, double reach) {
  std::vector<double> breaks = tunnel.height.breaks(chainage - reach, chainage + reach);
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
