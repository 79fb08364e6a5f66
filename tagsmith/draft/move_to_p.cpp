// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/move_to_p.hpp"

#include <cmath>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {
namespace {

void change_stated(std::optional<double>& stated, double by) {
  if (stated) *stated += by;
}

}  // namespace

bool faces_as_wall(const SurveyedPoint& listed, const Grid& grid, const Tunnel& tunnel,
                   const TagTemplate& tag) {
  constexpr double kSame = radians(0.02);
  if (!listed.attitude || !listed.attitude->facing) return true;
  const Pose on_wall =
      plate_on_wall(tunnel, tag, wall_of(listed), world_from_grid(grid, listed.in_grid));
  const double by_wall = grid_heading_from_world(grid, facing_of(on_wall));
  return std::abs(wrapped_angle(*listed.attitude->facing - by_wall)) <= kSame;
}

void move_to_p(std::vector<SurveyedPoint>& points, const MeasuredPoint& point, const Grid& grid,
               const Tunnel& tunnel, const TagTemplate& tag) {
  constexpr int kRounds = 4;  // where the drive bends
  Survey survey;
  survey.grid = grid;
  survey.tunnel = tunnel;
  survey.tag_template = tag;
  const auto heading_at = [&](double chainage) {
    return grid_heading_from_world(grid, tunnel.centerline.at(chainage).heading);
  };
  for (SurveyedPoint& listed : points) {
    if (!is_tag(listed)) continue;
    const TagName name{0, wall_of(listed)};
    const PlacedTag measured = place_surveyed(survey, name, listed.in_grid, listed.attitude);
    const bool turns = listed.attitude && faces_as_wall(listed, grid, tunnel, tag);
    PlacedTag moved = measured;
    for (int round = 0; round < kRounds; ++round) {
      std::optional<PlateAttitude> attitude = listed.attitude;
      if (turns && attitude->facing) {
        attitude->facing = wrapped_angle(*attitude->facing + heading_at(moved.chainage) -
                                         heading_at(measured.chainage));
      }
      const Eigen::Vector3d p =
          measured.world_from_plate.translation -
          moved.world_from_plate.rotation.leftCols<2>() * Eigen::Vector2d(point.right, point.down);
      moved = place_surveyed(survey, name, grid_from_world(grid, p), attitude);
    }
    listed.in_grid = moved.p_in_grid;
    listed.attitude = moved.attitude;
    change_stated(listed.chainage, moved.chainage - measured.chainage);
    change_stated(listed.offset, offset_of_p(survey, moved) - offset_of_p(survey, measured));
    change_stated(listed.height, height_of_p(survey, moved) - height_of_p(survey, measured));
  }
}

}  // namespace tagsmith::detail
