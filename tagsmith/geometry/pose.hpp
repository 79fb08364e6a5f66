// SPDX-License-Identifier: Apache-2.0
// Rigid transforms, named target_from_source.
#pragma once

#include <Eigen/Core>

namespace tagsmith::detail {

// x_target = rotation * x_source + translation, metres, right-handed frames.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

// a_from_b * b_from_c = a_from_c.
Pose operator*(const Pose& a_from_b, const Pose& b_from_c);

// The source point in the target frame.
Eigen::Vector3d operator*(const Pose& a_from_b, const Eigen::Vector3d& point_in_b);

Pose inverse(const Pose& a_from_b);

// Rz(yaw) Ry(pitch) Rx(roll), radians: in an x-forward, y-left, z-up frame yaw is positive to the
// left, pitch positive nose down, roll positive to the right (REP-103).
Eigen::Matrix3d rotation_from_yaw_pitch_roll(double yaw, double pitch, double roll);

// The rotation by this rotation vector: about its direction by its length, radians.
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& turn);

// The angle of the rotation that leads from one to the other, radians.
double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

}  // namespace tagsmith::detail
