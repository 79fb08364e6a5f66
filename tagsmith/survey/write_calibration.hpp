// SPDX-License-Identifier: Apache-2.0
// Camera calibrations as other programs read them.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/geometry/camera.hpp"

namespace tagsmith::detail {

enum class CalibrationFormat {
  opencv,  // cv::FileStorage in YAML, as OpenCV's calibration sample writes it
  ros,     // sensor_msgs/CameraInfo as camera_calibration_parsers reads and writes it
  kalibr,  // a camchain of one camera, cam0
};

// A calibration and the rest of its file.
struct CalibrationNotes {
  std::string camera_name;            // of ROS's file and kalibr's topic
  std::vector<std::string> comments;  // a line each: where it comes from and how good it is
  double rms_px = 0;                  // of the residuals; 0 = unknown
};

// The text of a file that read_calibration and the format's own program read back as this camera,
// to the last bit of each number. Perspective cameras have five coefficients, or eight where k4, k5
// or k6 is not zero; fisheyes four. Fails where the format has no such lens: kalibr's radtan has
// only k1, k2, p1 and p2.
Result<std::string> calibration_text(CalibrationFormat format, const Camera& camera,
                                     const CalibrationNotes& notes);

}  // namespace tagsmith::detail
