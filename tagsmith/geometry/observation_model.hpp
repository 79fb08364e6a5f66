// SPDX-License-Identifier: Apache-2.0
// The measurements of plates and walls by a vehicle's cameras and range sensors, and their
// derivatives by everything they depend on. The planner predicts with it, the localizer fits with
// it.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/centerline.hpp"
#include "tagsmith/geometry/chainage_profile.hpp"
#include "tagsmith/geometry/pose.hpp"

namespace tagsmith::detail {

// Where a vehicle's origin O is and how the vehicle stands there; world frame, metres, radians.
struct VehiclePose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double heading = 0;  // of its x axis, from +y towards +x
  double pitch = 0;    // positive nose down
  double roll = 0;     // positive to the right
};

Pose world_from_vehicle(const VehiclePose& vehicle);

// The vehicle whose frame this is; pitch within a quarter turn either way.
VehiclePose vehicle_pose_of(const Pose& world_from_vehicle);

// Standard deviations of by_motion's parameters (metres, radians) of a vehicle that drives `way`
// metres meanwhile: it may sway and bounce by a tenth of that, and turn about any axis as on a
// circle of 10 m.
Eigen::Matrix<double, 6, 1> motion_sigmas(double way);

// The order of a vehicle's six parameters in derivatives and covariances.
namespace vehicle_parameter {
enum : int { kX, kY, kZ, kHeading, kPitch, kRoll, kCount };
}

using VehicleCovariance = Eigen::Matrix<double, 6, 6>;  // metres and radians, squared

// A vehicle's pose prepared for many observations.
struct VehicleFrame {
  Pose world_from_vehicle;
  // Columns: the axis in the vehicle frame about which heading, pitch and roll turn it.
  Eigen::Matrix3d turn_axes = Eigen::Matrix3d::Identity();
};

VehicleFrame vehicle_frame(const VehiclePose& vehicle);

// A point of a plate in an image. Rotations are small rotation vectors, applied on the right of the
// rotation they disturb (R exp(w)), so they are in the axes of the frame that turns.
struct ObservedPoint {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 6> by_vehicle;     // x, y, z, heading, pitch, roll
  Eigen::Matrix<double, 2, 6> by_plate;       // shift in world axes; rotation about P, plate axes
  Eigen::Matrix<double, 2, 6> by_mounting;    // of the camera: shift in vehicle axes; rotation
  Eigen::Matrix<double, 2, 4> by_intrinsics;  // relative change of the focal lengths; cx, cy; k1
  // The vehicle's motion while a rolling shutter passes over the image, from the first row to the
  // last, in its axes: shift; turn about O.
  Eigen::Matrix<double, 2, 6> by_motion;
  // Likewise its motion from its stated pose until the picture is taken.
  Eigen::Matrix<double, 2, 6> by_delay;
};

// The place where a camera sees a point of a plate, in the image or beside it. Nothing for a point
// that the camera cannot see from there (see `project`).
std::optional<ObservedPoint> observe_point(const Camera& camera, const Pose& vehicle_from_camera,
                                           const VehicleFrame& vehicle,
                                           const Pose& world_from_plate,
                                           const Eigen::Vector3d& point_in_plate);

// How the corners of a quadrilateral (clockwise in the image, as u, v, u, v, ...) move when each of
// its sides moves outward by a pixel.
Eigen::Matrix<double, 8, 1> by_outward_edges(const Eigen::Matrix<double, 8, 1>& corners);

// A range to a wall.
struct ObservedWall {
  double distance = 0;                                    // negative behind the wall
  Eigen::Vector3d by_position = Eigen::Vector3d::Zero();  // of O, world frame
};

// The least horizontal distance from O to the surface that runs `wall_offset` metres to the right
// of the center line (negative: to the left), near the center line's nearest point.
ObservedWall observe_wall(const Centerline& centerline, const ChainageProfile& wall_offset,
                          const Eigen::Vector3d& position);

}  // namespace tagsmith::detail
