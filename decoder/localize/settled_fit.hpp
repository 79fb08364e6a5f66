// SPDX-License-Identifier: Apache-2.0
// Where the vehicle is by a joint fit, once it is known what the fit rests on: with the calibration
// as the rig says it wherever the pictures bear it out.
#pragma once

#include "decoder/localize/joint_model.hpp"

namespace tagsmith::detail {

// A pose, and how well it is known with everything that survey and rig call uncertain.
struct SettledFit {
  JointState state;
  VehicleCovariance covariance = VehicleCovariance::Zero();  // world axes, as of JointFit
  VehicleBudget budget;                                      // adds up to the covariance
  double chi_square = 0;
  int degrees_of_freedom = 0;
};

// A fit that may change the calibration spreads noise over it and trusts ranges more; one that
// weighs corners by an error of all edges alike no longer tells the better corner. Where the same
// measurements agree with calibration and edges as they are said (they would disagree more once in
// a thousand), the pose is the one by these; else it is the fit's own. The covariance is
// that of the error about the pose: the fit's own, and the square of how far the two poses are
// apart, which counts as of the calibration. Why: docs/decisions/0020-unstated-is-not-exact.md.
SettledFit settled(const JointProblem& problem, const JointFit& fit);

}  // namespace tagsmith::detail
