// SPDX-License-Identifier: Apache-2.0
// Localization by one least-squares fit of the vehicle's pose to everything measured: the corners
// of all tags in all cameras, the ranges, and how the vehicle usually stands.
#pragma once

#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The vehicle's pose.
//
// Start: each seen tag alone allows one or two poses (plate_poses). Each is fitted, and the other
// tags that agree with it are determined; the largest set of tags that agree is fitted together,
// tags that contradict it are dropped, and ranges that contradict the tags are dropped. What was
// dropped is listed in the fix with the reason.
//
// No position, with the reason: no tag; as many tags contradict the largest set as it has; one
// nearly frontal or far tag (or several on one plane) allows two poses that the measurements do not
// distinguish; the solution lies in the rock, or the vehicle would have to lean or float (six
// standard deviations of the rig's, with a single tag four); every one of several ranges
// contradicts a single tag.
//
// The tags of all surveys count, which are in one grid. The survey of the fix is the one in whose
// tunnel it lies. Surveys contradict each other where no tag of one agrees with those of the
// others, or where its tags together stand beside the others': then there is no position, however
// many tags each has. A smaller displacement is in the covariance.
//
// Parts of tags count like tags where what is in sight fits one tag of the surveys; where it fits
// several, the one is used that agrees with a position computed without the part. Parts without a
// whole tag give no position.
//
// Covariance: that of the fit, in which corners (their own covariance), plates (surveyed places,
// angles against the wall, rounding of coded positions), calibration, ranges and the vehicle's
// stance each have their standard deviations from the reader, survey and rig. A tag whose four
// corners fit a rectangle worse than their covariance says has that covariance raised until they
// do.
Fix localize_jointly(const Observation& observation, const std::vector<Survey>& surveys,
                     const Rig& rig);

}  // namespace tagsmith::detail
