// SPDX-License-Identifier: Apache-2.0
// The angle theta of the paper's method for two tags, which the localizer computes with and the
// planner expects.
#pragma once

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The angle theta for a tag on the left wall and one on the right. The one that the survey states,
// when the tags' stagger along the drive is that of a pair, either way round, to an eighth of the
// pitch; else, and when the survey states none, atan(|stagger| / W_T). The margin is for positions
// like those of the paper's Table 4, which are 58 mm (a fourteenth of the pitch) off the theta that
// its authors computed with; in the corridor as designed, tags of two different pairs are off by a
// seventh.
double pair_angle_for(const Survey& survey, const PlacedTag& left, const PlacedTag& right);

// The heading of the drive (world frame) midway between two tags, from how their plates hang.
double heading_between(const PlacedTag& left, const PlacedTag& right);

}  // namespace tagsmith::detail
