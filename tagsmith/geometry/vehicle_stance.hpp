// SPDX-License-Identifier: Apache-2.0
// How a vehicle stands on the floor of a drive, which it follows uphill and downhill.
#pragma once

#include <Eigen/Core>

#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/geometry/observation_model.hpp"

namespace tagsmith::detail {

// A vehicle's place and attitude against the floor below it; metres, radians.
struct FloorStance {
  double height = 0;   // of O above the floor, vertically
  double lateral = 0;  // of O to the right of the center line
  double yaw = 0;      // of its heading against the drive's, to the right
  double pitch = 0;    // against the floor in its own direction, positive nose down
  double roll = 0;     // likewise, positive to the right
};

// The vehicle that stands so at a place of the center line. A floor of grade g under a heading
// turned by yaw rises by g cos(yaw) ahead and by g sin(yaw) to the left.
VehiclePose vehicle_on_floor(const CenterlinePoint& floor, const FloorStance& stance);

// A vehicle's height, pitch and roll against the floor, and their derivatives by its parameters x,
// y, z, heading, pitch, roll.
struct ObservedStance {
  Eigen::Vector3d height_pitch_roll = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, 6> by_vehicle = Eigen::Matrix<double, 3, 6>::Zero();
};

ObservedStance observe_stance(const Centerline& centerline, const VehiclePose& vehicle);

// The same where the floor is known: `floor` is the center line's place abreast of the vehicle.
ObservedStance observe_stance(const CenterlinePoint& floor, const VehiclePose& vehicle);

}  // namespace tagsmith::detail
