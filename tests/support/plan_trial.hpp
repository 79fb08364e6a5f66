// SPDX-License-Identifier: Apache-2.0
// A plan's promise of accuracy tried out: a pose, what is measured there with the noise that the
// plan assumes, and what the localizer makes of it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/placement/expected_accuracy.hpp"
#include "tests/support/draws.hpp"

namespace tagsmith::detail::test {

struct PlanTrial {
  VehiclePose truth;
  CenterlinePoint floor;           // below the vehicle
  std::vector<PlateSight> sights;  // that are read
  Observation observation;
};

// How the vehicle stands in trials: within the rig's envelope (without one, a tenth of the width to
// either side and 5 degrees), and off by the rig's priors where `tilts`.
struct TrialPoses {
  double from = 0;  // chainage, metres
  double to = 0;
  bool tilts = true;
};

// Corners by the plan's own sights and sigmas; plates and cameras off by the survey's and the
// rig's. Ranges within their sensors' limits. No sights where nothing is read.
PlanTrial draw_trial(const SightModel& model, const TrialPoses& poses,
                     const AccuracyOptions& options, Draws& draws);

// What the plan expects of the joint method at the trial's pose.
std::optional<VehicleCovariance> expected_covariance(const SightModel& model,
                                                     const PlanTrial& trial,
                                                     const AccuracyOptions& options);

// Error of a fix's x, y, z, heading, pitch, roll; world frame.
Eigen::Matrix<double, 6, 1> error_in_world(const Fix& fix, const VehiclePose& truth,
                                           const Grid& grid);

// Errors over what was expected of them.
struct TrialTally {
  int trials = 0;    // with a sight
  int expected = 0;  // of these, where the plan expects a position
  int located = 0;   // of these
  Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();  // error^2 / variance
  double nees_position = 0;
  double nees_pose = 0;
  int in_ellipse = 0;  // of 95 % in the plane

  // Observed over expected standard deviations of along, across, z, heading, pitch, roll.
  Eigen::Matrix<double, 6, 1> ratios() const { return (squares / located).cwiseSqrt(); }
};

// Adds an error, x and y turned along and across the drive.
void count(TrialTally& tally, const Eigen::Matrix<double, 6, 1>& error,
           const VehicleCovariance& expected, double drive_heading);

}  // namespace tagsmith::detail::test
