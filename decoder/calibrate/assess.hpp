// SPDX-License-Identifier: Apache-2.0
// Whether photos are enough for a calibration that one can trust, and what to do where they are
// not.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "decoder/calibrate/calibrate_camera.hpp"
#include "decoder/calibrate/ray_sigma.hpp"

namespace tagsmith::detail {

enum class CalibrationIssue {
  focal_unknown,      // measured: relative sigma of the focal length
  rays_unknown,       // measured: worst ray sigma, pixels
  too_few_photos,     // measured: photos used
  not_covered,        // measured: worst ray sigma where no corner was seen, pixels
  all_frontal,        // measured: the greatest tilt, radians
  photo_contradicts,  // measured: its chi-square over its degrees of freedom, rooted
  photo_zoomed,       // measured: relative change of its focal length
  photos_differ,      // measured: the photo factor
  tags_left_out,      // measured: their share
  board_bowed,        // measured: metres out of the plane
  board_stretched,    // measured: relative
  residuals_larger,   // measured: the sigma factor
};

// The effect of an issue on the calibration.
enum class CalibrationTrust {
  good,     // advice alone
  weak,     // usable within the covariance stated, but worse than a calibration should be
  refused,  // not to be used
};

std::string_view to_string(CalibrationIssue issue);
std::string_view to_string(CalibrationTrust trust);

struct CalibrationFinding {
  CalibrationIssue issue = CalibrationIssue::focal_unknown;
  CalibrationTrust trust = CalibrationTrust::good;
  double measured = 0;
  double limit = 0;     // the limit for it
  std::string message;  // what was found
  std::string remedy;   // what to do
  std::optional<std::size_t> view{};
  std::optional<std::size_t> board{};
  std::vector<std::size_t> cells{};  // of RayGrid, that are not covered
};

// A focal length from a data sheet is known to 2 %, a principal point to 1 % of the width
// (docs/decisions/0013-unstated-is-not-exact.md): a calibration must at least halve that.
inline constexpr double kRefusedFocal = 0.01;
inline constexpr double kRefusedRay = 0.005;  // of the picture's width
// What localization assumes for a calibration file that states nothing (ibid.).
inline constexpr double kWeakFocal = 0.001;
inline constexpr double kWeakRay = 1;  // pixels

struct CalibrationAssessment {
  CalibrationTrust trust = CalibrationTrust::good;  // the worst of all findings
  std::vector<CalibrationFinding> findings;         // the worst first
  RayGrid grid;
  double focal_sigma = 0;  // relative
};

// The verdict is based on the sigmas of rays and focal length; what is missing (tilt, corners,
// photos) is named as their remedy. All contradictions are named in addition.
CalibrationAssessment assess_calibration(const CameraCalibration& calibration,
                                         std::span<const BoardView> views,
                                         std::span<const Board> boards);

// "upper left", of RayGrid's cells.
std::string_view cell_name(std::size_t cell);

}  // namespace tagsmith::detail
