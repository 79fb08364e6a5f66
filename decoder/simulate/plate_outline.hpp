// SPDX-License-Identifier: Apache-2.0
// The rectangles of a plate as polygons in the image.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

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

}  // namespace tagsmith::detail
