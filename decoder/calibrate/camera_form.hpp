// SPDX-License-Identifier: Apache-2.0
// Which of a camera's parameters a calibration determines, and how pixels move with them.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <Eigen/Core>

#include "tagsmith/geometry/camera.hpp"

namespace tagsmith::detail {

// A camera's parameters in the order fx, fy, cx, cy, then the eight of Camera::distortion.
inline constexpr Eigen::Index kCameraParameters = 12;
using CameraVector = Eigen::Matrix<double, kCameraParameters, 1>;
using CameraCovariance = Eigen::Matrix<double, kCameraParameters, kCameraParameters>;

CameraVector parameters_of(const Camera& camera);

// The camera with these parameters in place of its own.
Camera with_parameters(Camera camera, const CameraVector& parameters);

// d(pixel)/d(parameters) of a point of the camera frame that has a pixel (tagsmith/geometry's
// project).
Eigen::Matrix<double, 2, kCameraParameters> by_parameters(const Camera& camera,
                                                          const Eigen::Vector3d& point_in_camera);

// A lens model by the coefficients that are not zero.
struct LensForm {
  std::string_view name;  // "k1 k2 p1 p2"
  LensModel lens = LensModel::perspective;
  std::size_t coefficients = 0;  // how many are free
  unsigned free = 0;             // bit i: Camera::distortion[i] is
};

// The forms of a lens, each with those before it as special cases, the simplest first: perspective
// with none, {k1}, {k1, k2}, {k1, k2, p1, p2}, {k1, k2, p1, p2, k3}, {k1, k2, p1, p2, k3, k4}, all
// eight; fisheye with none, {k1, k2}, {k1 to k4}.
std::span<const LensForm> lens_forms(LensModel lens);

// A lens's form, and whether the focal lengths are one (square pixels). The principal point is
// always free, within a prior (kCenterSigma).
struct CameraForm {
  LensForm lens;
  bool square_pixels = true;

  // Number of free parameters of the camera: 3 or 4 with the coefficients.
  Eigen::Index parameters() const {
    return static_cast<Eigen::Index>(lens.coefficients) + (square_pixels ? 3 : 4);
  }
};

std::string to_string(const CameraForm& form);

// CameraVector by the form's free parameters: a column each. The one focal length of square pixels
// moves fx and fy alike.
Eigen::Matrix<double, kCameraParameters, Eigen::Dynamic> free_parameters(const CameraForm& form);

// Standard deviation of the principal point from the picture's middle before anything is measured,
// as a share of the picture's width: twice the value for a rig that states none
// (docs/decisions/0013-unstated-is-not-exact.md), because nothing at all is known of the camera.
inline constexpr double kCenterSigma = 0.02;

// What is known of the parameters before anything is measured, as standard deviations about zero
// (distortion), about the middle (principal point) and about the current value (focal length: as
// large as itself, so that what no photo shows stays finite). No coefficient alone moves the point
// at the radius `outermost` (of the plane z = 1; of a fisheye the angle) by more than that radius.
CameraVector prior_sigmas(const Camera& camera, double outermost);

}  // namespace tagsmith::detail
