// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/measured_point.hpp"

namespace tagsmith::detail {

// Whether the plate of this tag faces as the wall of `tunnel` does there, by what the list states
// or because it states nothing.
bool faces_as_wall(const SurveyedPoint& listed, const Grid& grid, const Tunnel& tunnel,
                   const TagTemplate& tag);

// Moves tags whose plates were measured at `point` to P, along the walls of `tunnel`, or as the
// list states the plates' attitudes. Stated chainages, offsets and heights of tags change with it,
// and a facing that is the wall's turns with the drive.
void move_to_p(std::vector<SurveyedPoint>& points, const MeasuredPoint& point, const Grid& grid,
               const Tunnel& tunnel, const TagTemplate& tag);

}  // namespace tagsmith::detail
