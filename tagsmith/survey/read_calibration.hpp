// SPDX-License-Identifier: Apache-2.0
// Camera calibrations as other programs write them. Internal to tagsmith/survey.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/geometry/camera.hpp"

namespace tagsmith::detail {

struct CalibrationRequest {
  std::filesystem::path file;
  std::string camera;              // its key in a file of several; empty = the only one
  std::optional<LensModel> model;  // what four coefficients mean where the file does not say
};

// Reads these formats, distinguished by their contents:
// - OpenCV's FileStorage, YAML or XML: camera_matrix, distortion_coefficients (4, 5 or 8; 12 or 14
//   with nothing in the last ones), image_width, image_height, fisheye_model;
// - ROS sensor_msgs/CameraInfo, as camera_calibration_parsers writes it and as a message is
//   printed: distortion_model plumb_bob, rational_polynomial or equidistant. For raw images: the
//   rectification is left out;
// - kalibr's camchain: camera_model pinhole, distortion_model radtan, equidistant or none.
// The camera's width and height are 0 when the file does not say them. Fails only when the file
// cannot be read at all.
Result<Diagnosed<Camera>> read_calibration(const CalibrationRequest& request);

}  // namespace tagsmith::detail
