// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/pair_angle.hpp"

#include <cmath>

#include "tagsmith/geometry/centerline.hpp"

namespace tagsmith::detail {
namespace {

// Part of the pitch by which a pair's stagger may differ from W_T tan(theta).
// Why: docs/decisions/0015-closed-form-of-the-paper.md.
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
