// SPDX-License-Identifier: Apache-2.0
// What a rig states of a calibrated camera.
#pragma once

#include "decoder/calibrate/calibrate_camera.hpp"

namespace tagsmith::detail {

// CalibrationSigma's focal (relative) and center (pixels).
struct IntrinsicsSigma {
  double focal = 0;
  double center = 0;
};

// A rig knows no covariance of the distortion: its two numbers stand for all that is uncertain of
// the rays. `center` is the ray sigma (ray_sigma_px) at the principal point. `focal` is the
// calibration's own, or larger where that takes for the two to make, in the mean of the squares
// over the picture, what the ray sigmas make. Parts of the picture without a ray do not count.
IntrinsicsSigma rig_sigma(const CameraCalibration& calibration);

}  // namespace tagsmith::detail
