// SPDX-License-Identifier: Apache-2.0
// Where plates truly are in an image.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "decoder/simulate/scene.hpp"
#include "tagsmith/geometry/camera.hpp"

namespace tagsmith::detail {

struct PlateTruth {
  // Inner corners of the feature frame P, F, R (lower right), Q in pixels, also beyond the image's
  // edge; nothing behind the camera or outside of the lens model's reach.
  std::array<std::optional<Eigen::Vector2d>, 4> corners;
  double module_px = 0;  // width of a module at the middle of the frame; 0 where it has no pixel
  double incidence = 0;  // radians between the line of sight to that middle and the plate's normal
  // Share of the feature frame's surface (strokes included) that lies in the image, in front of the
  // backdrop and of the other plates, not under its cover; 0 for a plate seen from behind. Counted
  // on 48 x 24 points.
  double visible_fraction = 0;
};

// One truth for each plate, in their order. A backdrop has the camera's size.
std::vector<PlateTruth> plate_truths(const Camera& camera, std::span<const ScenePlate> plates,
                                     const Backdrop* backdrop = nullptr);

// True when the camera is on the plate's printed side.
bool faces_camera(const ScenePlate& plate);

// Middle of the feature frame in the camera frame.
Eigen::Vector3d frame_middle_in_camera(const ScenePlate& plate);

// The depth (z in the camera frame) at which the ray (x, y, 1) meets the plate's plane; nothing
// when it meets it behind the camera or is all but parallel to it.
std::optional<double> depth_on_plate(const ScenePlate& plate, const Eigen::Vector3d& ray);

// Plate coordinates (x right, y down from P) of a point of the plate's plane.
Eigen::Vector2d point_on_plate(const ScenePlate& plate, const Eigen::Vector3d& point_in_camera);

}  // namespace tagsmith::detail
