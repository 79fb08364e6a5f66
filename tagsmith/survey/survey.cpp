// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/survey.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

const PlacedTag* find_if(const Survey& survey, const auto& matches) {
  const auto tag = std::ranges::find_if(survey.tags, matches);
  return tag == survey.tags.end() ? nullptr : &*tag;
}

// Numbers of the EPSG register (version 10.076), from the first to the last of each row, of systems
// in degrees, in feet or other lengths that are no metres, or of heights alone; none of a row is in
// metres. Only longer rows are listed; many others have a number or two.
struct NumberRange {
  int first;
  int last;
};
constexpr std::array kNotInMetres{
    NumberRange{2222, 2289},   NumberRange{2867, 2930},   NumberRange{3417, 3438},
    NumberRange{3451, 3459},   NumberRange{3560, 3570},   NumberRange{3728, 3739},
    NumberRange{4000, 4025},   NumberRange{4027, 4036},   NumberRange{4039, 4047},
    NumberRange{4120, 4389},   NumberRange{4399, 4413},   NumberRange{4418, 4433},
    NumberRange{4490, 4490},   NumberRange{4600, 4646},   NumberRange{4657, 4765},
    NumberRange{4801, 4811},   NumberRange{4813, 4821},   NumberRange{4882, 5013},
    NumberRange{5368, 5381},   NumberRange{5600, 5625},   NumberRange{5709, 5799},
    NumberRange{5861, 5874},   NumberRange{6128, 6141},   NumberRange{6178, 6187},
    NumberRange{6317, 6325},   NumberRange{7034, 7073},   NumberRange{7119, 7128},
    NumberRange{7587, 7686},   NumberRange{7832, 7844},   NumberRange{7900, 7931},
    NumberRange{8226, 8267},   NumberRange{8397, 8431},   NumberRange{8518, 8675},
    NumberRange{8860, 8902},   NumberRange{8915, 8949},   NumberRange{8972, 9019},
    NumberRange{9053, 9140},   NumberRange{9392, 9403},   NumberRange{9775, 9784},
    NumberRange{26729, 26813}, NumberRange{26847, 26870}, NumberRange{32001, 32058}};

}  // namespace

// Why: docs/decisions/0001-frames-grids-and-walls.md.
Eigen::Vector3d world_from_grid(const Grid& grid, const Eigen::Vector3d& point_in_grid) {
  const double x = grid.x_axis_left ? 0.0 - point_in_grid.x() : point_in_grid.x();
  return {x, point_in_grid.y(), point_in_grid.z()};
}

Eigen::Vector3d grid_from_world(const Grid& grid, const Eigen::Vector3d& point_in_world) {
  return world_from_grid(grid, point_in_world);  // a mirror is its own inverse
}

std::optional<int> parse_crs(std::string_view text) {
  constexpr std::string_view kRegister = "EPSG:";
  if (!text.starts_with(kRegister)) return std::nullopt;
  const std::optional<int> number = parse_integer(text.substr(kRegister.size()));
  if (!number || *number < 1024 || *number > 999'999) return std::nullopt;
  const bool in_metres = std::ranges::none_of(kNotInMetres, [&](const NumberRange& range) {
    return *number >= range.first && *number <= range.last;
  });
  return in_metres ? number : std::nullopt;
}

double world_heading_from_grid(const Grid& grid, double heading) {
  return grid.x_axis_left ? -heading : heading;
}

double grid_heading_from_world(const Grid& grid, double heading) {
  return world_heading_from_grid(grid, heading);
}

std::string attitude_text(const PlateAttitude& attitude) {
  const auto in_degrees = [](double angle) {
    return format_number(degrees(std::abs(angle)), 2) + " degrees";
  };
  std::vector<std::string> parts;
  if (attitude.facing)
    parts.push_back("faces " + format_number(degrees(*attitude.facing), 2) + " degrees");
  if (attitude.tilt != 0) {
    parts.push_back("leans " + in_degrees(attitude.tilt) +
                    (attitude.tilt > 0 ? " forward" : " back"));
  }
  if (attitude.roll != 0) {
    parts.push_back("is turned " + in_degrees(attitude.roll) +
                    (attitude.roll > 0 ? " clockwise" : " anticlockwise"));
  }
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text.empty() ? "stands upright" : text;
}

const std::optional<PlateAttitude>& usual_attitude(const Survey& survey, Side side) {
  return survey.usual_attitudes[side == Side::left ? 0 : 1];
}

bool has_own_attitude(const Survey& survey, const PlacedTag& tag) {
  return tag.attitude && tag.attitude != usual_attitude(survey, tag.side);
}

std::string usual_attitudes_text(const Survey& survey) {
  const auto& [left, right] = survey.usual_attitudes;
  if (!left && !right) return {};
  const std::string on_left = attitude_text(left.value_or(PlateAttitude{}));
  const std::string on_right = attitude_text(right.value_or(PlateAttitude{}));
  return on_left == on_right ? "every plate " + on_left
                             : "every left plate " + on_left + "; every right one " + on_right;
}

const PlacedTag* find_tag(const Survey& survey, const Digits& digits) {
  return find_if(survey, [&](const PlacedTag& tag) { return tag.digits == digits; });
}

const PlacedTag* find_tag(const Survey& survey, std::string_view name) {
  return find_if(survey, [&](const PlacedTag& tag) { return tag.name == name; });
}

double facing_pair_angle(const Survey& survey, double chainage) {
  return std::atan2(survey.tag_template.frame_inner_length, width_at(survey.tunnel, chainage));
}

double pair_width(const Tunnel& tunnel, const PlacedTag& left, const PlacedTag& right) {
  return wall_distance(tunnel, Side::left, left.chainage) +
         wall_distance(tunnel, Side::right, right.chainage);
}

Eigen::Matrix3d plate_rotation(double facing, double tilt, double roll) {
  const Eigen::Vector3d y = -Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d into_wall = -direction_of(facing);
  Eigen::Matrix3d upright;
  upright << y.cross(into_wall), y, into_wall;
  if (tilt == 0 && roll == 0) return upright;
  return upright * (Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) *
                    Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
                       .toRotationMatrix();
}

PlateAttitude attitude_of(const Grid& grid, const Pose& world_from_plate) {
  const double facing = facing_of(world_from_plate);
  PlateAttitude attitude;
  attitude.facing = grid_heading_from_world(grid, facing);
  attitude.tilt = std::asin(std::clamp(world_from_plate.rotation(2, 2), -1.0, 1.0));
  const Eigen::Matrix3d roll =
      plate_rotation(facing, attitude.tilt).transpose() * world_from_plate.rotation;
  attitude.roll = std::atan2(roll(1, 0), roll(0, 0));
  return attitude;
}

double facing_of(const Pose& world_from_plate) {
  constexpr double kLying = 1e-6;
  const Eigen::Vector3d out = -world_from_plate.rotation.col(2);
  const Eigen::Vector3d up = -world_from_plate.rotation.col(1);
  const Eigen::Vector3d& facing = out.head<2>().norm() > kLying ? out : up;
  return std::atan2(facing.x(), facing.y());
}

Pose plate_on_wall(const Tunnel& tunnel, const TagTemplate& tag, Side side,
                   const Eigen::Vector3d& p_in_world) {
  const double towards_right =
      side == Side::left ? 1.0 : -1.0;  // a viewer's right, along the drive
  const auto along_wall = [&](double at) {
    return direction_of(wall_heading(tunnel, side, at, tag.plate_length));
  };
  double chainage = tunnel.centerline.locate(p_in_world.head<2>()).chainage;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Eigen::Vector3d middle =
        p_in_world + towards_right * tag.frame_inner_length / 2 * along_wall(chainage);
    const double next = tunnel.centerline.locate(middle.head<2>()).chainage;
    const bool settled = std::abs(next - chainage) < 1e-12;
    chainage = next;
    if (settled) break;
  }
  const Eigen::Vector3d x = towards_right * along_wall(chainage);
  const Eigen::Vector3d y(0, 0, -1);
  Pose world_from_plate;
  world_from_plate.rotation.col(0) = x;
  world_from_plate.rotation.col(1) = y;
  world_from_plate.rotation.col(2) = x.cross(y);
  world_from_plate.translation = p_in_world;
  return world_from_plate;
}

bool is_turned_from_wall(const Tunnel& tunnel, const TagTemplate& tag, const PlacedTag& placed) {
  constexpr double kTurned = radians(15);
  if (!placed.attitude || !placed.attitude->facing) return false;
  const Pose& stands = placed.world_from_plate;
  const Pose wall = plate_on_wall(tunnel, tag, placed.side, stands.translation);
  return std::abs(wrapped_angle(facing_of(stands) - facing_of(wall))) > kTurned;
}

}  // namespace tagsmith::detail
