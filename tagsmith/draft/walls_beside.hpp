// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Adds points of both walls, half the width (metres) beside each point of the center line, where a
// design has only a center line. Points CL are in order along the drive. Fails where there are
// fewer than two of them, and where there are points of walls.
Result<void> add_walls_beside(std::vector<SurveyedPoint>& points, const Grid& grid, double width);

}  // namespace tagsmith::detail
