// SPDX-License-Identifier: Apache-2.0
// How well a calibration determines the rays of its pixels, and what a rig states of that.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "decoder/calibrate/calibrate_camera.hpp"

namespace tagsmith::detail {

// The standard deviation, in the direction in which it is largest, of the pixel at which a fixed
// ray of the camera frame is seen: how far the ray through `pixel` may be off, in pixels. Poses are
// marginal.
//
// Every form that was tried counts by its weight, with its own covariance and with its difference
// from the chosen one (Hoeting et al. 1999, "Bayesian model averaging: a tutorial", (3)): where no
// corner was seen, the richer forms are uncertain even if the chosen one is not. Nothing where the
// chosen camera has no ray, or a form whose weight is more than one in a thousand cannot see it.
std::optional<double> ray_sigma_px(const CameraCalibration& calibration,
                                   const Eigen::Vector2d& pixel);

// The picture in equal cells.
struct RayGrid {
  static constexpr int kColumns = 4;
  static constexpr int kRows = 3;
  struct Cell {
    Eigen::Vector2d worst_pixel = Eigen::Vector2d::Zero();
    double worst_sigma_px = 0;  // infinite where the chosen camera has a ray and ray_sigma_px none
    bool has_ray = false;       // else the cell lies outside of a fisheye's circle
    int corners = 0;            // used ones that were seen there
  };
  std::array<Cell, std::size_t{kColumns} * kRows> cells{};  // row by row from the upper left

  // The greatest of all cells.
  double worst_sigma_px() const;
};

// ray_sigma_px at 9 points of each cell, those on the picture's border included.
RayGrid ray_grid(const CameraCalibration& calibration);

// Relative standard deviation of the focal length, all forms tried counted as above.
double focal_sigma(const CameraCalibration& calibration);

// ---- What a rig states of a calibrated camera.

// CalibrationSigma's focal (relative) and center (pixels).
struct IntrinsicsSigma {
  double focal = 0;
  double center = 0;
};

// A rig states no covariance of the distortion: its two numbers represent the whole uncertainty of
// the rays. `center` is the ray sigma (ray_sigma_px) at the principal point. `focal` is the
// calibration's own, or larger where that is needed for the two numbers to give, as the mean of the
// squares over the picture, the ray sigmas. Parts of the picture without a ray do not count.
IntrinsicsSigma rig_sigma(const CameraCalibration& calibration);

}  // namespace tagsmith::detail
