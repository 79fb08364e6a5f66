// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/place_tags.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {

// ---- Plates on the walls.

namespace {

GridPoint to_grid_point(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

// Turns a plate that is upright and faces away from its wall.
void take_attitude(const std::optional<PlateAttitude>& attitude, const Grid& grid, PlacedTag& tag) {
  tag.attitude = attitude;
  if (!attitude) return;
  const double facing = attitude->facing ? world_heading_from_grid(grid, *attitude->facing)
                                         : facing_of(tag.world_from_plate);
  tag.world_from_plate.rotation = plate_rotation(facing, attitude->tilt, attitude->roll);
}

}  // namespace

std::string tag_name(int pair, Side side) {
  return fmt::format("{:03}{}", pair, side == Side::left ? 'L' : 'R');
}

std::optional<TagName> parse_tag_name(std::string_view name) {
  if (name.size() < 2) return std::nullopt;
  const std::string_view number = name.substr(0, name.size() - 1);
  const bool digits = std::ranges::all_of(number, [](char c) { return c >= '0' && c <= '9'; });
  const std::optional<int> pair = digits ? parse_integer(number) : std::nullopt;
  if (!pair) return std::nullopt;
  const TagName parsed{*pair, name.back() == 'R' ? Side::right : Side::left};
  if (tag_name(parsed.pair, parsed.side) != name) return std::nullopt;
  return parsed;
}

double right_plate_shift(const Survey& survey, double chainage) {
  if (!survey.series || !survey.series->pair_angle) return 0;
  return width_at(survey.tunnel, chainage) * std::tan(*survey.series->pair_angle) -
         survey.tag_template.frame_inner_length;
}

double left_middle(const Survey& survey, int pair) {
  const TagTemplate& tag = survey.tag_template;
  const double pitch = tag.plate_length + survey.series->spacing;
  return survey.series->first + tag.frame_inner_length / 2 + pair * pitch;
}

PlacedTag place_in_series(const Survey& survey, int pair, Side side) {
  const TagSeries& series = *survey.series;
  const TagTemplate& tag_template = survey.tag_template;
  const Tunnel& tunnel = survey.tunnel;
  const Centerline& line = tunnel.centerline;
  const double abreast = left_middle(survey, pair);
  const double middle =
      side == Side::right ? abreast + right_plate_shift(survey, abreast) : abreast;

  const CenterlinePoint point = line.at(middle);
  const double to_right = side == Side::left ? -1.0 : 1.0;
  const double heading = wall_heading(tunnel, side, middle, tag_template.plate_length);
  const Eigen::Vector3d back_to_p =
      to_right * tag_template.frame_inner_length / 2 * direction_of(heading);
  Eigen::Vector3d p = point.position +
                      to_right * wall_distance(tunnel, side, middle) * right_of(point.heading) +
                      back_to_p;
  PlacedTag tag;
  tag.name = tag_name(pair, side);
  tag.sigma = survey.sigma;
  tag.pair = pair;
  tag.side = side;
  tag.chainage = line.locate(p.head<2>()).chainage;
  p.z() = line.at(tag.chainage).position.z() + series.mount_height;
  tag.p_in_grid = grid_from_world(survey.grid, p) + Eigen::Vector3d::Zero();  // -0 becomes 0
  const Eigen::Vector3d x = -to_right * direction_of(heading);
  tag.world_from_plate.rotation << x, -Eigen::Vector3d::UnitZ(), to_right * right_of(heading);
  tag.world_from_plate.translation = p;
  take_attitude(usual_attitude(survey, side), survey.grid, tag);
  return tag;
}

PlacedTag place_surveyed(const Survey& survey, const TagName& name,
                         const Eigen::Vector3d& p_in_grid,
                         const std::optional<PlateAttitude>& attitude) {
  const Eigen::Vector3d p = world_from_grid(survey.grid, p_in_grid);
  PlacedTag tag;
  tag.name = tag_name(name.pair, name.side);
  tag.pair = name.pair;
  tag.side = name.side;
  tag.p_in_grid = p_in_grid;
  tag.world_from_plate = plate_on_wall(survey.tunnel, survey.tag_template, name.side, p);
  take_attitude(attitude ? attitude : usual_attitude(survey, name.side), survey.grid, tag);
  tag.chainage = survey.tunnel.centerline.locate(p.head<2>()).chainage;
  tag.surveyed = true;
  tag.sigma = survey.sigma;
  return tag;
}

std::optional<PlacedTag> with_own_digits(PlacedTag tag, const PositionCode& code) {
  const auto encoded = encode_position(code, to_grid_point(tag.p_in_grid));
  if (!encoded) return std::nullopt;
  return with_digits(std::move(tag), code, encoded->digits);
}

PlacedTag with_digits(PlacedTag tag, const PositionCode& code, const Digits& digits) {
  const GridPoint coded = decode_position(code, digits);
  tag.digits = digits;
  tag.coded_in_grid = {coded[0], coded[1], coded[2]};
  return tag;
}

// ---- In words for the people who hang them.

double height_of_p(const Survey& survey, const PlacedTag& tag) {
  return tag.world_from_plate.translation.z() -
         survey.tunnel.centerline.at(tag.chainage).position.z();
}

double offset_of_p(const Survey& survey, const PlacedTag& tag) {
  return survey.tunnel.centerline.locate(tag.world_from_plate.translation.head<2>()).offset;
}

double usual_tolerance(const Survey& survey) {
  constexpr double kTapeAndLevel = 0.005;
  return survey.states_sigma ? std::max(2 * survey.sigma, kTapeAndLevel) : kTapeAndLevel;
}

std::vector<SettingOut> setting_out(const Survey& survey, std::span<const PlacedTag* const> tags,
                                    double tolerance) {
  std::vector<SettingOut> list;
  for (const PlacedTag* tag : tags) {
    list.push_back(
        {tag, tag->chainage, offset_of_p(survey, *tag), height_of_p(survey, *tag), tolerance});
  }
  return list;
}

// ---- The angle theta.

namespace {

// Part of the pitch by which a pair's stagger may differ from W_T tan(theta).
// Why: docs/decisions/0011-smoothing-and-paper-method.md.
constexpr double kStaggerMargin = 1.0 / 8;

}  // namespace

double heading_between(const PlacedTag& left, const PlacedTag& right) {
  // A viewer's right is forward at the left wall and backward at the right wall.
  const Eigen::Vector3d along =
      left.world_from_plate.rotation.col(0) - right.world_from_plate.rotation.col(0);
  return std::atan2(along.x(), along.y());
}

double pair_angle_for(const Survey& survey, const PlacedTag& left, const PlacedTag& right) {
  const Eigen::Vector3d between = world_from_grid(survey.grid, right.p_in_grid - left.p_in_grid);
  const double stagger = std::abs(between.dot(direction_of(heading_between(left, right))));
  const double width = pair_width(survey.tunnel, left, right);
  if (survey.series && survey.series->pair_angle) {
    const double stated = *survey.series->pair_angle;
    const double pitch = survey.tag_template.plate_length + survey.series->spacing;
    const double difference = std::abs(stagger - width * std::tan(std::abs(stated)));
    if (difference < kStaggerMargin * pitch) return std::abs(stated);
  }
  return std::atan2(stagger, width);
}

}  // namespace tagsmith::detail
