// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/rig_sigma.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "decoder/calibrate/ray_sigma.hpp"

namespace tagsmith::detail {

using Eigen::Vector2d;

// A ray's pixel moves by `center`, and by `focal` times its distance from the principal point.
IntrinsicsSigma rig_sigma(const CameraCalibration& calibration) {
  constexpr int kPoints = 12;  // in each direction
  const Camera& camera = calibration.camera;
  const Vector2d middle(camera.cx, camera.cy);
  const double center = ray_sigma_px(calibration, middle).value_or(0);
  double excess = 0;  // over center^2, summed
  double radii = 0;   // squared, summed
  for (int x = 0; x < kPoints; ++x) {
    for (int y = 0; y < kPoints; ++y) {
      const Vector2d pixel((camera.width - 1.0) * x / (kPoints - 1),
                           (camera.height - 1.0) * y / (kPoints - 1));
      const std::optional<double> sigma = ray_sigma_px(calibration, pixel);
      if (!sigma) continue;
      excess += *sigma * *sigma - center * center;
      radii += (pixel - middle).squaredNorm();
    }
  }
  const double by_rays = radii > 0 ? std::sqrt(std::max(0.0, excess / radii)) : 0;
  return {std::max(by_rays, focal_sigma(calibration)), center};
}

}  // namespace tagsmith::detail
