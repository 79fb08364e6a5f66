// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/survey.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace tagsmith {
namespace {

const PlacedTag* find_if(const Survey& survey, const auto& matches) {
  const auto tag = std::ranges::find_if(survey.tags, matches);
  return tag == survey.tags.end() ? nullptr : &*tag;
}

}  // namespace

std::string to_string(Side side) { return side == Side::left ? "left" : "right"; }

Eigen::Vector3d world_from_grid(const Grid& grid, const Eigen::Vector3d& point_in_grid) {
  const double x = grid.x_axis_left ? 0.0 - point_in_grid.x() : point_in_grid.x();
  return {x, point_in_grid.y(), point_in_grid.z()};
}

Eigen::Vector3d grid_from_world(const Grid& grid, const Eigen::Vector3d& point_in_world) {
  return world_from_grid(grid, point_in_world);  // a mirror is its own inverse
}

double world_heading_from_grid(const Grid& grid, double heading) {
  return grid.x_axis_left ? -heading : heading;
}

double grid_heading_from_world(const Grid& grid, double heading) {
  return world_heading_from_grid(grid, heading);
}

const PlacedTag* find_tag(const Survey& survey, const Digits& digits) {
  return find_if(survey, [&](const PlacedTag& tag) { return tag.digits == digits; });
}

const PlacedTag* find_tag(const Survey& survey, std::string_view name) {
  return find_if(survey, [&](const PlacedTag& tag) { return tag.name == name; });
}

double facing_pair_angle(const Survey& survey) {
  return std::atan2(survey.tag_template.frame_inner_length, survey.tunnel.width);
}

Pose plate_on_wall(const Tunnel& tunnel, const TagTemplate& tag, Side side,
                   const Eigen::Vector3d& p_in_world) {
  const double towards_right =
      side == Side::left ? 1.0 : -1.0;  // a viewer's right, along the drive
  double chainage = tunnel.centerline.locate(p_in_world.head<2>()).chainage;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Eigen::Vector3d along = direction_of(tunnel.centerline.at(chainage).heading);
    const Eigen::Vector3d middle = p_in_world + towards_right * tag.frame_inner_length / 2 * along;
    const double next = tunnel.centerline.locate(middle.head<2>()).chainage;
    const bool settled = std::abs(next - chainage) < 1e-12;
    chainage = next;
    if (settled) break;
  }
  const Eigen::Vector3d x = towards_right * direction_of(tunnel.centerline.at(chainage).heading);
  const Eigen::Vector3d y(0, 0, -1);
  Pose world_from_plate;
  world_from_plate.rotation.col(0) = x;
  world_from_plate.rotation.col(1) = y;
  world_from_plate.rotation.col(2) = x.cross(y);
  world_from_plate.translation = p_in_world;
  return world_from_plate;
}

}  // namespace tagsmith
