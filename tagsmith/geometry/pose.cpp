// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/pose.hpp"

#include <Eigen/Geometry>

namespace tagsmith::detail {

Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
  return {a_from_b.rotation * b_from_c.rotation, a_from_b * b_from_c.translation};
}

Eigen::Vector3d operator*(const Pose& a_from_b, const Eigen::Vector3d& point_in_b) {
  return a_from_b.rotation * point_in_b + a_from_b.translation;
}

Pose inverse(const Pose& a_from_b) {
  const Eigen::Matrix3d rotation = a_from_b.rotation.transpose();
  return {rotation, -(rotation * a_from_b.translation)};
}

Eigen::Matrix3d rotation_from_yaw_pitch_roll(double yaw, double pitch, double roll) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
          AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

}  // namespace tagsmith::detail
