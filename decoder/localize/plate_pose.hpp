// SPDX-License-Identifier: Apache-2.0
// A plate's pose from its four corners in one image: the two that a planar rectangle allows.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "tagsmith/geometry/pose.hpp"

namespace tagsmith::detail {

// Both camera_from_plate that a rectangle's perspective picture allows, by Infinitesimal
// Plane-based Pose Estimation (Collins and Bartoli 2014, "Infinitesimal Plane-Based Pose
// Estimation", IJCV 109). Seen obliquely one is far better than the other; nearly from the front,
// or from afar, both explain the picture (Schweighofer and Pinz 2006, "Robust pose estimation from
// a planar target").
//
// `rays`: the directions (x, y, 1) to P, F, the lower right corner and Q in the camera frame;
// `length` and `height` of the rectangle, metres. Nothing when the corners cannot be the picture of
// a rectangle seen from its front.
std::optional<std::array<Pose, 2>> plate_poses(const std::array<Eigen::Vector3d, 4>& rays,
                                               double length, double height);

}  // namespace tagsmith::detail
