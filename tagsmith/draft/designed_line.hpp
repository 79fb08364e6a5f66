// SPDX-License-Identifier: Apache-2.0
// The alignment of a design, as its file has it. Internal to tagsmith/survey, except in lists of
// points.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// A line, an arc or a clothoid. The curvature changes evenly from one value to another (1/length,
// positive to the right where x grows to the right of y).
struct DesignedElement {
  double length = 0;
  double from = 0;
  double to = 0;
};

// In the file's grid, seen from above; headings from +y towards +x.
struct DesignedLine {
  Eigen::Vector2d start{0, 0};
  double heading = 0;  // radians
  std::vector<DesignedElement> elements;
};

// The line with another unit of length.
DesignedLine scaled(DesignedLine line, double factor);

// In the world, level.
Centerline line_in_world(const DesignedLine& line, const Grid& grid);

}  // namespace tagsmith::detail
