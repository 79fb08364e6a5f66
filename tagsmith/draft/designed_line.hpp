// SPDX-License-Identifier: Apache-2.0
// The alignment of a design, as its file has it. Internal to tagsmith/survey, except in lists of
// points.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// In the file's grid, seen from above; headings from +y towards +x.
struct DesignedLine {
  Eigen::Vector2d start{0, 0};
  double heading = 0;  // radians
  // Lines, arcs and clothoids; curvatures are positive to the right where x grows to the right of
  // y.
  std::vector<Clothoid> elements;
};

// The line with another unit of length.
DesignedLine scaled(DesignedLine line, double factor);

// In the world, level.
Centerline line_in_world(const DesignedLine& line, const Grid& grid);

}  // namespace tagsmith::detail
