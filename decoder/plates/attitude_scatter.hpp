// SPDX-License-Identifier: Apache-2.0
// How far plates are turned from their surveyed attitudes, from pictures that show several.
#pragma once

#include "decoder/plates/plate_adjustment.hpp"

namespace tagsmith::detail {

// The standard deviation about each axis, radians, that the scatter of the plates does not exceed
// with a probability of 97.5 %, given the pictures: a posterior quantile. Plates of one station are
// compared in pairs by how their single pictures turn against each other, so that shifted plates
// have no effect; a plate seen from many places counts once; and a pair may hold a plate that hangs
// quite wrong, which then says nothing. Known beforehand is that plates hung by eye and spirit
// level are within a degree or so: every magnitude from 0.05 to 0.5 degrees is as likely as any
// other, larger ones ever less. Pictures that contain no information give 0.55 degrees.
enum class ComparedPlates {
  of_station,
  of_picture,  // an error of the cameras' mounting has no effect
};
double attitude_scatter(const AdjustmentProblem& problem,
                        ComparedPlates compared = ComparedPlates::of_station);

}  // namespace tagsmith::detail
