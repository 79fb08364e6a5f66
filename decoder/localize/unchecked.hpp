// SPDX-License-Identifier: Apache-2.0
// Which mistakes of survey, rig and photos a measurement would not reveal: the external
// reliability of a position (Baarda 1968, "A Testing Procedure for Use in Geodetic Networks",
// Netherlands Geodetic Commission, vol. 2, no. 5).
#pragma once

#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/joint_model.hpp"

namespace tagsmith::detail {

// Each kind of mistake that could move the position by more than four of its standard deviations
// while chi-square stays as in right measurements, with the greatest shift. A mistake is a
// displacement of the fit's rows along the derivatives by what is wrong, as large as gross mistakes
// are (a metre, a radian, a third of a focal length); taken linearly at the solution. Last come the
// three that no single measurement can reveal.
//
// `variance_factor`: the factor by which the fit's covariance is raised in the fix.
std::vector<Unchecked> unchecked_by(const JointProblem& problem, const JointFit& fit,
                                    double variance_factor);

}  // namespace tagsmith::detail
