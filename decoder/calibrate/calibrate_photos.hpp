// SPDX-License-Identifier: Apache-2.0
// A camera from photo files' pixels: read, calibrate, read again knowing the camera, calibrate.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "decoder/calibrate/board_view.hpp"
#include "decoder/calibrate/calibrate_camera.hpp"
#include "decoder/image/gray.hpp"
#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// Photos by their number, loaded when they are needed: twice each. Several threads call it at once.
struct PhotoSource {
  std::vector<std::string> files;  // names, for messages and results
  std::function<Result<GrayImage>(std::size_t)> load;
};

struct PhotoCalibrationOptions {
  int jobs = 0;  // photos read at once; 0 = as many as cores
  // Called after each photo of either reading, one call at a time: progress.
  std::function<void(std::size_t done, std::size_t of)> on_read;
};

struct PhotoCalibration {
  CameraCalibration calibration;
  std::vector<BoardView> views;  // as read last; calibration's view numbers count these
};

// Fails as calibrate_camera does, and where a photo cannot be loaded.
Result<PhotoCalibration> calibrate_photos(const PhotoSource& photos, std::span<const Board> boards,
                                          const PhotoCalibrationOptions& options = {});

}  // namespace tagsmith::detail
