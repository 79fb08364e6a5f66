// SPDX-License-Identifier: Apache-2.0
// How a vehicle moves between two fixes: constant velocities in x, y, z and heading, disturbed by
// white accelerations, and a Kalman filter's two steps over them.
#pragma once

#include <optional>
#include <set>
#include <string>

#include <Eigen/Core>

#include "decoder/localize/fix.hpp"

namespace tagsmith::detail {

// How the vehicle moves. Accelerations are white noise: in one second they change a velocity by
// this standard deviation, in t seconds by sqrt(t) times as much.
struct MotionModel {
  double acceleration = 0.5;   // along x and y, m/s^2: a crawler or loader that brakes and turns
  double climb = 0.1;          // along z, m/s^2: floors are uneven
  double turn = 0.2;           // of the heading, rad/s^2
  double speed = 3;            // standard deviation before anything is known, m/s
  double turn_rate = 0.5;      // likewise, rad/s
  double longest_gap = 5;      // seconds from the nearest measured position; beyond: no position
  double largest_sigma = 0.1;  // metres, of a predicted position in its worst direction; likewise
};

// x, y, z, heading in the survey's grid, metres and radians, and their rates a second.
using MotionState = Eigen::Matrix<double, 8, 1>;
using MotionCovariance = Eigen::Matrix<double, 8, 8>;
using VehiclePlace = Eigen::Vector4d;
using PlaceCovariance = Eigen::Matrix4d;

// What is known of the motion at one time.
struct MotionEstimate {
  MotionState mean = MotionState::Zero();
  MotionCovariance covariance = MotionCovariance::Zero();
};

// What a fix measures of the vehicle's place.
struct MeasuredPlace {
  VehiclePlace place;
  PlaceCovariance covariance;
  double shared = 0;  // share of the covariance that neighbouring fixes have in common
};

// Nothing without a position. The fix must have an attitude.
std::optional<MeasuredPlace> measured_by(const Fix& fix);

// Before the first fix: at that place, within a hundred metres and with any heading.
MotionEstimate motion_from(const VehiclePlace& place, const MotionModel& motion);

// The matrix that takes a state `dt` seconds on with its rates kept.
MotionCovariance transition_over(double dt);

// The estimate `dt` seconds later.
MotionEstimate predicted(const MotionEstimate& estimate, double dt, const MotionModel& motion);

struct MotionUpdate {
  MotionEstimate estimate;  // updated with the place
  double distance2 = 0;     // of the place from the motion, chi-square of four
  bool agrees = false;      // as all but one in 10,000 do
};

// A Kalman filter's step: the prediction with what was measured at its time.
MotionUpdate updated(const MotionEstimate& predicted, const MeasuredPlace& measured);

// The tags that a track uses, as unique_tags() names them.
struct TrackTags {
  std::set<std::string> latest;     // of the latest fix
  std::set<std::string> confirmed;  // seen with another at once, or linked by motion to one
};

// Adds the tags of a fix that agrees with the motion predicted for it. Returns whether that
// confirms it: the latest fix saw another tag, the motion is known so well that a plate a decimetre
// off would have been noticed, and the fix lies within the limit that one in a hundred right ones
// exceeds; or the fix uses one tag, and that was confirmed before. A plate that hangs wrong is not
// confirmed by its own earlier fixes.
bool take_in(TrackTags& tags, const MotionEstimate& predicted, const MotionUpdate& update,
             const Fix& fix);

// The fix with the motion's confirmation.
Fix confirmed_by_motion(Fix fix);

}  // namespace tagsmith::detail
