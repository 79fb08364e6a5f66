// SPDX-License-Identifier: Apache-2.0
// Where the vehicle is by a joint fit, once it is known what the fit rests on: with calibration and
// edges as the rig and the pictures say them wherever the measurements bear it out.
#pragma once

#include "decoder/localize/joint_model.hpp"

namespace tagsmith {

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
// measurements agree with calibration and edges as they are said (less than once in a thousand they
// would disagree more), the pose is the one by these, and the uncertainty of both is carried into
// the covariance as that of considered parameters (Jazwinski 1970, "Stochastic Processes and
// Filtering Theory", 8.4); else it is the fit's own. Either covariance is that of the error.
SettledFit settled(const JointProblem& problem, const JointFit& fit);

}  // namespace tagsmith
