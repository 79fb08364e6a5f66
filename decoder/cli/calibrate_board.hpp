// SPDX-License-Identifier: Apache-2.0
// `calibrate` from photos of boards: a camera's intrinsics.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

struct BoardCalibrationOptions {
  std::vector<std::string> photos;
  std::vector<std::string> boards;
  std::string output;             // empty = none
  std::string format = "opencv";  // of the output
  std::string html;
  std::string drawing;
  std::string rig;     // takes the camera over; empty = none
  std::string camera;  // empty = "camera"
  bool json = false;
  int jobs = 0;
};

// Reads, fits, prints and writes; the exit code. Fails on wrong use and on what cannot be read.
Result<int> calibrate_by_boards(const BoardCalibrationOptions& options);

}  // namespace tagsmith::detail
