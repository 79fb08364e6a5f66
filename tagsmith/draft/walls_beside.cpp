// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/walls_beside.hpp"

#include <algorithm>

namespace tagsmith::detail {

Result<void> add_walls_beside(std::vector<SurveyedPoint>& points, const Grid& grid, double width) {
  std::vector<SurveyedPoint> line;
  for (const SurveyedPoint& point : points) {
    if (point.kind == PointKind::left_wall || point.kind == PointKind::right_wall) {
      return fail("--width is for lists without points of walls (WL, WR)");
    }
    if (point.kind == PointKind::centerline) line.push_back(point);
  }
  if (line.size() < 2) return fail("--width needs an alignment, or points of the center line (CL)");
  const auto in_world = [&](std::size_t i) { return world_from_grid(grid, line[i].in_grid); };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Eigen::Vector3d along =
        in_world(std::min(i + 1, line.size() - 1)) - in_world(i - (i > 0));
    const Eigen::Vector3d right = Eigen::Vector3d(along.y(), -along.x(), 0).normalized();
    for (const PointKind kind : {PointKind::left_wall, PointKind::right_wall}) {
      SurveyedPoint wall = line[i];
      wall.kind = kind;
      wall.has_height = false;
      wall.of_alignment = true;
      const double aside = (kind == PointKind::right_wall ? 0.5 : -0.5) * width;
      wall.in_grid = grid_from_world(grid, in_world(i) + aside * right);
      points.push_back(std::move(wall));
    }
  }
  return {};
}

}  // namespace tagsmith::detail
