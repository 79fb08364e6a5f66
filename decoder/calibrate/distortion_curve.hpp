// SPDX-License-Identifier: Apache-2.0
// A lens's distortion along the radius, for a chart.
#pragma once

#include <optional>
#include <vector>

#include "decoder/calibrate/calibrate_camera.hpp"

namespace tagsmith::detail {

struct DistortionPoint {
  double radius = 0;  // from the principal point, pixels: the mean over all directions
  // How far outward of where a lens without distortion of the same focal length shows the same ray:
  // perspective f tan(angle), fisheye f angle. Pixels.
  double displacement = 0;
  double sigma = 0;               // of `radius` for this ray, by the covariance of the form chosen
  std::optional<double> other{};  // the runner-up's radius minus `radius`
};

struct DistortionCurve {
  std::vector<DistortionPoint> points;  // from the middle to the farthest corner with a ray
  std::optional<std::size_t> other{};   // the runner-up in CameraCalibration::tried
  double seen_radius = 0;               // of the farthest corner that was used, pixels
};

// The tried form with the least BIC after the chosen one; nothing where only one was tried.
std::optional<std::size_t> runner_up(const CameraCalibration& calibration);

DistortionCurve distortion_curve(const CameraCalibration& calibration);

}  // namespace tagsmith::detail
