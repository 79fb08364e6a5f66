// SPDX-License-Identifier: Apache-2.0
// OpenCV's calibration with its own targets, to compare with, where it is installed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "decoder/image/gray.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail::bench {

// A target's drawing on a plate of this size in metres, and the camera that OpenCV makes of photos
// of it; nothing when it makes none.
struct OtherTarget {
  std::string name;
  TagDrawing (*draw)(double width, double height);
  std::optional<Camera> (*calibrate)(const std::vector<GrayImage>& photos, double width,
                                     double height);
};

// A chessboard by findChessboardCornersSB, one by findChessboardCorners with cornerSubPix, and a
// ChArUco board, each calibrated with five coefficients as by default; empty without OpenCV's
// calib3d and aruco.
const std::vector<OtherTarget>& other_targets();

}  // namespace tagsmith::detail::bench
