// SPDX-License-Identifier: Apache-2.0
// Where a plate is in an image: its rectangles as polygons, and the truth about its corners and how
// much of it is seen.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "decoder/simulate/scene.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// ---- The rectangles of a plate as polygons in the image.

// The part of space that a camera can see and a little more, as bounds of x/z and y/z and of their
// distance from the axis.
struct ViewingFrustum {
  double left = 0;
  double right = 0;
  double top = 0;
  double bottom = 0;
  double reach = 0;       // the camera's
  double nearest = 0.01;  // metres of depth
};

// Bounds of what the image shows, `margin_px` wider on each side.
ViewingFrustum viewing_frustum(const Camera& camera, double margin_px);

// The rectangle's picture in pixels, clockwise on the screen when the plate faces the camera; empty
// when nothing of it lies in the frustum, outside of which it is cut off. Under lens distortion its
// sides are followed to 1e-3 px; where they leave the lens model's reach, to its border.
std::vector<Eigen::Vector2d> outline_in_image(const Camera& camera, const ViewingFrustum& frustum,
                                              const Pose& camera_from_plate,
                                              const Rectangle& rectangle);

// ---- Where plates truly are in an image.

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
