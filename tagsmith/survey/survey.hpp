// SPDX-License-Identifier: Apache-2.0
// A surveyed tunnel and the tags in it.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/survey/tunnel.hpp"
#include "tagsmith/symbology/position_code.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// The mine's grid. Geometry inside the program is right-handed, x, y, z up, and called "world"; a
// grid whose x axis points to the left of +y is mirrored here and nowhere else.
struct Grid {
  bool x_axis_left = false;
  int epsg = 0;  // number of the coordinate reference system in the EPSG register; 0 = not named
};

// "EPSG:25832" as its number; nothing for other text, and for systems in degrees that are common.
std::optional<int> parse_crs(std::string_view text);

Eigen::Vector3d world_from_grid(const Grid& grid, const Eigen::Vector3d& point_in_grid);
Eigen::Vector3d grid_from_world(const Grid& grid, const Eigen::Vector3d& point_in_world);

// A heading (radians from +y towards +x) in the other frame.
double world_heading_from_grid(const Grid& grid, double heading);
double grid_heading_from_world(const Grid& grid, double heading);

// The regular pairs (design: `tags`).
struct TagSeries {
  double mount_height = 0;  // H_P, of corner P above the floor
  double spacing = 0;       // W_B, clear gap between neighbouring plates of one wall
  double first = 0;         // chainage of the left P of pair 0
  int pairs = 0;
  std::optional<double> pair_angle;  // theta, radians; absent = plates face each other exactly
};

// The attitude of one plate that does not hang as its wall says. Radians.
struct PlateAttitude {
  std::optional<double> facing;  // grid heading of its face; absent = away from its wall
  double tilt = 0;               // of its upper edge out of the wall: the plate looks down
  double roll = 0;               // in its own plane, clockwise as a viewer sees it

  bool operator==(const PlateAttitude&) const = default;
};

// "faces 270 degrees, leans 3 degrees out of the wall": in words, for drawings and lists.
std::string attitude_text(const PlateAttitude& attitude);

// A tag where it hangs.
struct PlacedTag {
  std::string name;  // pair and side: 000L
  int pair = 0;
  Side side = Side::left;
  Digits digits{};                                          // as printed
  Eigen::Vector3d p_in_grid = Eigen::Vector3d::Zero();      // corner P
  Eigen::Vector3d coded_in_grid = Eigen::Vector3d::Zero();  // the position that the digits code
  Pose world_from_plate;  // plate frame: origin P, x right, y down, z into the wall
  double chainage = 0;    // of corner P
  bool surveyed = false;  // from `placed` (as-built), not from the regular series
  bool control = false;   // surveyed so well that an adjustment of the others relies on it
  double sigma = 0;       // standard deviation of a coordinate of P, metres
  std::string date;       // of the measurement, as 2026-03-31; empty = not given
  std::optional<Eigen::Vector3d> design_in_grid;  // P as designed, where `placed` moved it
  std::optional<PlateAttitude> attitude;          // absent = upright, as its wall faces
  int line = 0;  // its line in the survey's file, from 1; 0 = it has none
  int column = 0;
};

struct Survey {
  std::filesystem::path file;
  std::string name;
  Grid grid;
  Tunnel tunnel;
  TagTemplate tag_template;
  std::optional<TagSeries> series;
  // Of the plates of each Side that state none, without `facing`; absent = upright.
  std::array<std::optional<PlateAttitude>, 2> usual_attitudes;
  double sigma =
      0;  // standard deviation of a surveyed coordinate, metres; a tag takes it when placed
  double angle_sigma = 0;  // of a plate's attitude against its wall, about each axis, radians
  // False where the file does not state it and the reader assumed the usual value
  // (assumptions.hpp).
  bool states_sigma = true;
  bool states_angle_sigma = true;
  PositionCode code;
  std::vector<PlacedTag> tags;  // by pair, left before right
};

const std::optional<PlateAttitude>& usual_attitude(const Survey& survey, Side side);

// Whether a tag has an attitude that is not the usual one of its side.
bool has_own_attitude(const Survey& survey, const PlacedTag& tag);

// "every plate leans 3 degrees forward": the usual attitudes in words; empty where plates are
// upright.
std::string usual_attitudes_text(const Survey& survey);

// The tag with these digits, or null.
const PlacedTag* find_tag(const Survey& survey, const Digits& digits);
const PlacedTag* find_tag(const Survey& survey, std::string_view name);

// The angle theta of facing plates, atan(L_CI / W_T), where the tunnel is as wide as here.
double facing_pair_angle(const Survey& survey, double chainage);

// W_T of two tags' walls, each at its own tag.
double pair_width(const Tunnel& tunnel, const PlacedTag& left, const PlacedTag& right);

// The pose of a plate whose corner P is at `p_in_world` on the given wall: vertical, parallel to
// the wall over the plate's length about its frame's middle.
Pose plate_on_wall(const Tunnel& tunnel, const TagTemplate& tag, Side side,
                   const Eigen::Vector3d& p_in_world);

// The attitude of a plate that stands so: plate_rotation's angles, `facing` in the grid.
PlateAttitude attitude_of(const Grid& grid, const Pose& world_from_plate);

// The rotation world_from_plate of a plate whose face points to `facing` (world heading).
Eigen::Matrix3d plate_rotation(double facing, double tilt = 0, double roll = 0);

// The world heading of a plate's face; for a plate on its back, that of its picture's up.
double facing_of(const Pose& world_from_plate);

// True when the plate turns out of its wall by more than 15 degrees: it hangs on a pillar or across
// the drive, and rules for plates on walls do not apply to it.
bool is_turned_from_wall(const Tunnel& tunnel, const TagTemplate& tag, const PlacedTag& placed);

}  // namespace tagsmith::detail
