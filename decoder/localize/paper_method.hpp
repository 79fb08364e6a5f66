// SPDX-License-Identifier: Apache-2.0
// Localization by the paper's closed form: two tags facing each other, one seen by each of two
// cameras, and the distance to the left wall. Xu et al. (2017), equations (6)-(23).
#pragma once

#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// O by the closed form.
//
// Tags: one on the left wall and one on the right, of one survey, seen by different cameras, at
// their surveyed positions; none that turns out of its wall by an attitude of its own. Where
// several choices exist, two tags of one pair go first, then the tags nearest each other along the
// drive, then those nearest the cameras (least D1 + D2), which are the largest in their images.
// Distances: (10) with P' and Q' where level cameras without distortion would have seen them; or as
// measured. From O the tags lie by as much before their places as the cameras stand away from O.
// The left tag's P' decides whether its camera stands above or below the tags; for measured
// distances the survey's and the rig's heights do. d: the least of the ranges to the left wall that
// lie in their sensor's limits.
//
// There is no heading: the method does not determine one. The covariance is propagated from the
// noise of d, of P' and Q' (of measured distances: what an outline's corners would give at that
// distance), of the cameras' calibration, the plates' attitude, the vehicle's heading, roll and
// pitch and the tags' surveyed positions, by a step of one standard deviation each way, of which
// the one counts that moves the position farther. A step that has no solution is halved until it
// has one and its effect scaled up, z at most to the tags' height; a note says that the covariance
// is rough. The paper uses d as the distance to the plane of the left plate, which it is not in a
// bend; and where coded positions contradict theta its result is not at d from the wall. The larger
// of the two differences counts as one more standard deviation of d, with a note.
//
// Without a position the fix says why. Never fails.
Fix localize_by_paper(const Observation& observation, const std::vector<Survey>& surveys,
                      const Rig& rig);

}  // namespace tagsmith::detail
