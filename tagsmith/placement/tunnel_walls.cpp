// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/tunnel_walls.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tagsmith {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kJoint = 1e-6;  // metres by which neighbouring pieces overlap

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

TunnelWalls::TunnelWalls(const Tunnel& tunnel, double standoff, double chainage, double reach) {
  const Centerline& line = tunnel.centerline;
  const double half_width = tunnel.width / 2 + standoff;
  const double first = chainage - reach;
  const double last = chainage + reach;
  if (first < 0) add(line.at(first), 0, -first, first, half_width);
  double start = 0;
  for (const CenterlineElement& element : line.elements()) {
    if (start + element.length >= first && start <= last) {
      add(line.at(start), element.curvature, element.length, start, half_width);
    }
    start += element.length;
  }
  if (last > line.length()) {
    add(line.at(line.length()), 0, last - line.length(), line.length(), half_width);
  }
}

void TunnelWalls::add(const CenterlinePoint& start, double curvature, double length,
                      double chainage, double half_width) {
  const Vector2d along = direction_of(start.heading).head<2>();
  const Vector2d across = right_of(start.heading).head<2>();
  for (const Side side : {Side::left, Side::right}) {
    const double offset = side == Side::left ? -half_width : half_width;
    const Vector2d on_wall = start.position.head<2>() + offset * across;
    if (curvature == 0) {
      straights_.push_back({on_wall, along, across, length, chainage, side});
      continue;
    }
    const Vector2d centre = start.position.head<2>() + across / curvature;
    // Left of a left turn's centre there is no wall.
    if ((1.0 / curvature - offset) * curvature <= 0) continue;
    const Vector2d from_centre = on_wall - centre;
    arcs_.push_back(
        {centre, from_centre.normalized(), from_centre.norm(), curvature, length, chainage, side});
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
  nearest = WallHit{way, wall.chainage + along, wall.side, std::abs(towards) / direction.norm()};
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
      const double offset = survey.tunnel.centerline.locate(corner.head<2>()).offset;
      farthest = std::max(farthest, std::abs(offset) - survey.tunnel.width / 2);
    }
  }
  return standoff_behind(farthest);
}

double standoff_behind(double farthest) {
  constexpr double kGap = 0.010;
  constexpr double kMost = 0.5;
  return std::min(std::max(farthest, 0.0) + kGap, kMost);
}

}  // namespace tagsmith
