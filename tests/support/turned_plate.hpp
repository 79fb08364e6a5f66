// SPDX-License-Identifier: Apache-2.0
// Plates at any pose before a camera.
#pragma once

#include <Eigen/Geometry>

#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// camera_from_plate of a plate seen squarely, then turned: the middle of the frame at `distance` on
// the ray through `pixel`; turned about the plate's vertical axis by `yaw` (positive: its right
// side goes away), about its horizontal axis by `pitch` (positive: its top goes away), and last in
// the image by `roll` (clockwise). Radians.
inline Pose camera_from_turned_plate(const Camera& camera, const TagDrawing& drawing,
                                     const Eigen::Vector2d& pixel, double distance, double yaw,
                                     double pitch, double roll) {
  using Eigen::AngleAxisd;
  Pose pose;
  pose.rotation =
      (AngleAxisd(roll, Eigen::Vector3d::UnitZ()) * AngleAxisd(pitch, Eigen::Vector3d::UnitX()) *
       AngleAxisd(-yaw, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  const Rectangle& inner = drawing.frame_inner;
  const Eigen::Vector3d middle(inner.x + inner.width / 2, inner.y + inner.height / 2, 0);
  pose.translation =
      distance * ray_through(camera, pixel).value().normalized() - pose.rotation * middle;
  return pose;
}

}  // namespace tagsmith::detail
