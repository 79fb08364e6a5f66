// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/rig.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

// Camera axes (x right, y down, z along the optical axis) of a camera that looks along a body's
// x axis (y left, z up).
Eigen::Matrix3d body_from_camera() {
  Eigen::Matrix3d rotation;
  rotation << 0, 0, 1,  //
      -1, 0, 0,         //
      0, -1, 0;
  return rotation;
}

}  // namespace

bool has_rolling_shutter(const Rig& rig) {
  return std::ranges::any_of(
      rig.cameras, [](const RigCamera& camera) { return camera.readout.value_or(0) > 0; });
}

bool has_delay(const Rig& rig) {
  return std::ranges::any_of(rig.cameras,
                             [](const RigCamera& camera) { return camera.delay.value_or(0) > 0; });
}

double usual_speed(const Rig& rig) {
  if (rig.envelope) return rig.envelope->speed;
  return has_rolling_shutter(rig) || has_delay(rig) ? kUsualSpeed : 0;
}

void set_motion_sigmas(Rig& rig) {
  const double speed = usual_speed(rig);
  for (RigCamera& camera : rig.cameras) {
    camera.calibration_sigma.shutter = camera.readout.value_or(0) * speed;
    camera.calibration_sigma.delay = camera.delay.value_or(0) * speed;
  }
}

bool stands_level(const Rig& rig) {
  constexpr double kUnsteady = radians(15);
  return rig.roll_sigma <= kUnsteady && rig.pitch_sigma <= kUnsteady;
}

const RigCamera* find_camera(const Rig& rig, std::string_view name) {
  const auto found = std::ranges::find(rig.cameras, name, &RigCamera::name);
  return found == rig.cameras.end() ? nullptr : &*found;
}

Pose vehicle_from_side_camera(Side side, double alpha) {
  const double yaw = std::numbers::pi / 2 - alpha;
  return vehicle_from_camera(side == Side::left ? yaw : -yaw, 0, 0, Eigen::Vector3d::Zero());
}

Pose vehicle_from_camera(double yaw, double pitch, double roll, const Eigen::Vector3d& position) {
  return {rotation_from_yaw_pitch_roll(yaw, pitch, roll) * body_from_camera(), position};
}

MountingAngles mounting_angles(const Pose& vehicle_from_camera) {
  const Eigen::Matrix3d body = vehicle_from_camera.rotation * body_from_camera().transpose();
  return {std::atan2(body(1, 0), body(0, 0)), std::asin(std::clamp(-body(2, 0), -1.0, 1.0)),
          std::atan2(body(2, 1), body(2, 2))};
}

Pose world_from_vehicle(const Eigen::Vector3d& position_in_world, double heading) {
  Pose pose;
  pose.rotation << direction_of(heading), -right_of(heading), Eigen::Vector3d::UnitZ();
  pose.translation = position_in_world;
  return pose;
}

}  // namespace tagsmith::detail
