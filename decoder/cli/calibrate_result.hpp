// SPDX-License-Identifier: Apache-2.0
// The result of `calibrate` from photos of boards, and what its outputs have in common.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/calibrate/assess.hpp"
#include "decoder/calibrate/calibrate_camera.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/tag/board.hpp"

namespace tagsmith::detail {

struct BoardCalibration {
  std::string camera_name;
  std::vector<Board> boards;
  CameraCalibration calibration;
  std::vector<BoardView> views;  // the photos, in the order given
  CalibrationAssessment assessment;
};

// What became of a photo.
struct PhotoUse {
  std::size_t tags = 0;  // of the boards, that were read
  std::size_t tags_used = 0;

  bool is_used() const { return tags_used > 0; }
};
std::vector<PhotoUse> photo_uses(const BoardCalibration& result);

// Photos with tags of which none was used, and photos without tags, by their place among the views.
std::vector<std::size_t> photos_left_out(const BoardCalibration& result);
std::vector<std::size_t> photos_without_tags(const BoardCalibration& result);

// One number of the camera.
struct CameraNumber {
  std::string name;  // "fx"
  double value = 0;
  double sigma = 0;
  std::string_view unit;  // "px", or empty

  // Its value or sigma: "1600.123 px", or "-0.123456".
  std::string in_words(double of) const;
};

// The parameters that the form leaves free: focal lengths ("f" for the one of square pixels),
// principal point, coefficients.
std::vector<CameraNumber> camera_numbers(const CameraCalibration& calibration);

// Names of Camera::distortion, as many as the lens has.
std::vector<std::string_view> coefficient_names(LensModel lens);

// Root mean square of the distances at the corners used, pixels, as OpenCV counts it.
double residual_rms_px(const CameraCalibration& calibration);

// "advice", "weak" or "refused".
std::string_view severity_of(const CalibrationFinding& finding);

// Sentences about the whole result, for the text, the page and the drawing alike.
std::vector<std::string> calibration_facts(const BoardCalibration& result);

// Coverage, residuals and distortion as pictures, and the results in words, on one sheet. Fails as
// lay_out_sheets does.
Result<std::vector<Sheet>> draw_calibration(const BoardCalibration& result);

// The same as one web page without further files.
std::string calibration_page(const BoardCalibration& result);

// "weak: of use within the sigmas stated ...".
std::string verdict_words(CalibrationTrust trust);

}  // namespace tagsmith::detail
