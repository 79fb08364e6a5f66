// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/camera_form.hpp"

#include <array>
#include <cmath>

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr Index kFirstCoefficient = 4;

// Bits of Camera::distortion: k1, k2, p1, p2, k3, k4, k5, k6.
constexpr std::array<LensForm, 7> kPerspective{{
    {"no distortion", LensModel::perspective, 0, 0x00},
    {"k1", LensModel::perspective, 1, 0x01},
    {"k1 k2", LensModel::perspective, 2, 0x03},
    {"k1 k2 p1 p2", LensModel::perspective, 4, 0x0f},
    {"k1 k2 p1 p2 k3", LensModel::perspective, 5, 0x1f},
    {"k1 to k4 p1 p2", LensModel::perspective, 6, 0x3f},
    {"k1 to k6 p1 p2", LensModel::perspective, 8, 0xff},
}};

// Bits of Camera::distortion: k1, k2, k3, k4.
constexpr std::array<LensForm, 3> kFisheye{{
    {"equidistant", LensModel::fisheye, 0, 0x0},
    {"k1 k2", LensModel::fisheye, 2, 0x3},
    {"k1 k2 k3 k4", LensModel::fisheye, 4, 0xf},
}};

using ByCoefficients = Eigen::Matrix<double, 2, 8>;

// The distorted point of the plane z = 1 by k1 to k4: theta (1 + k1 theta^2 + ...) / r.
ByCoefficients fisheye_by_coefficients(const Vector2d& ideal) {
  ByCoefficients by = ByCoefficients::Zero();
  const double r = ideal.norm();
  if (r == 0) return by;
  const double theta = std::atan(r);
  double power = theta;
  for (Index i = 0; i < 4; ++i) {
    power *= theta * theta;
    by.col(i) = power / r * ideal;
  }
  return by;
}

// The same by k1, k2, p1, p2, k3 to k6.
ByCoefficients perspective_by_coefficients(const Camera& camera, const Vector2d& ideal) {
  const std::array<double, 8>& k = camera.distortion;
  const double x = ideal.x();
  const double y = ideal.y();
  const double s = ideal.squaredNorm();
  const double numerator = 1 + s * (k[0] + s * (k[1] + s * k[4]));
  const double denominator = 1 + s * (k[5] + s * (k[6] + s * k[7]));
  ByCoefficients by;
  by.col(0) = s / denominator * ideal;
  by.col(1) = s * by.col(0);
  by.col(2) << 2 * x * y, s + 2 * y * y;
  by.col(3) << s + 2 * x * x, 2 * x * y;
  by.col(4) = s * by.col(1);
  by.col(5) = -numerator / denominator * by.col(0);
  by.col(6) = s * by.col(5);
  by.col(7) = s * by.col(6);
  return by;
}

}  // namespace

CameraVector parameters_of(const Camera& camera) {
  CameraVector parameters;
  parameters << camera.fx, camera.fy, camera.cx, camera.cy,
      Eigen::Map<const Eigen::Matrix<double, 8, 1>>(camera.distortion.data());
  return parameters;
}

Camera with_parameters(Camera camera, const CameraVector& parameters) {
  camera.fx = parameters[0];
  camera.fy = parameters[1];
  camera.cx = parameters[2];
  camera.cy = parameters[3];
  Eigen::Map<Eigen::Matrix<double, 8, 1>>(camera.distortion.data()) = parameters.tail<8>();
  return camera;
}

Eigen::Matrix<double, 2, kCameraParameters> by_parameters(const Camera& camera,
                                                          const Eigen::Vector3d& point_in_camera) {
  const Vector2d ideal = point_in_camera.head<2>() / point_in_camera.z();
  const Vector2d pixel = *project(camera, point_in_camera);
  Eigen::Matrix<double, 2, kCameraParameters> by;
  by.leftCols<4>() << (pixel.x() - camera.cx) / camera.fx, 0, 1, 0, 0,
      (pixel.y() - camera.cy) / camera.fy, 0, 1;
  const ByCoefficients distorted = camera.lens == LensModel::fisheye
                                       ? fisheye_by_coefficients(ideal)
                                       : perspective_by_coefficients(camera, ideal);
  by.rightCols<8>() = Vector2d(camera.fx, camera.fy).asDiagonal() * distorted;
  return by;
}

std::span<const LensForm> lens_forms(LensModel lens) {
  if (lens == LensModel::fisheye) return kFisheye;
  return kPerspective;
}

std::string to_string(const CameraForm& form) {
  std::string text = form.lens.lens == LensModel::fisheye ? "fisheye, " : "perspective, ";
  text += form.lens.name;
  return text + (form.square_pixels ? "" : ", fx and fy");
}

Eigen::Matrix<double, kCameraParameters, Eigen::Dynamic> free_parameters(const CameraForm& form) {
  Eigen::Matrix<double, kCameraParameters, Eigen::Dynamic> columns(kCameraParameters,
                                                                   form.parameters());
  columns.setZero();
  Index column = 0;
  columns(0, column) = 1;
  columns(1, form.square_pixels ? column : ++column) = 1;
  columns(2, ++column) = 1;
  columns(3, ++column) = 1;
  for (Index i = 0; i < 8; ++i) {
    if ((form.lens.free >> i & 1U) != 0) columns(kFirstCoefficient + i, ++column) = 1;
  }
  return columns;
}

CameraVector prior_sigmas(const Camera& camera, double outermost) {
  const double s = outermost * outermost;
  const double center = kCenterSigma * camera.width;
  CameraVector sigmas;
  sigmas << camera.fx, camera.fy, center, center, CameraVector::Constant(1).tail<8>();
  if (camera.lens == LensModel::fisheye) {
    sigmas.tail<8>() << 1 / s, 1 / (s * s), 1 / (s * s * s), 1 / (s * s * s * s), 1, 1, 1, 1;
  } else {
    const double decentring = 1 / outermost;
    sigmas.tail<8>() << 1 / s, 1 / (s * s), decentring, decentring, 1 / (s * s * s), 1 / s,
        1 / (s * s), 1 / (s * s * s);
  }
  return sigmas;
}

}  // namespace tagsmith::detail
