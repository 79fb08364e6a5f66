// SPDX-License-Identifier: Apache-2.0
// Cameras: OpenCV's perspective model with its eight-parameter distortion, and its fisheye model.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

namespace tagsmith::detail {

enum class LensModel {
  // OpenCV calib3d, "Detailed description": the ratio of two polynomials in the radius, and two
  // tangential terms. ROS calls it plumb_bob (five parameters) and rational_polynomial, kalibr
  // radtan.
  perspective,
  // OpenCV calib3d, "Fisheye camera model"; Kannala and Brandt 2006, "A generic camera model and
  // calibration method", (6) with its first term fixed: the radius is an odd polynomial in the
  // angle to the optical axis. ROS and kalibr call it equidistant.
  fisheye,
};

// Camera frame: x right, y down, z along the optical axis. Pixel (0, 0) is the centre of the upper
// left pixel.
struct Camera {
  int width = 0;   // pixels
  int height = 0;  // pixels
  double fx = 0;   // focal lengths and principal point, pixels
  double fy = 0;
  double cx = 0;
  double cy = 0;
  // perspective: k1, k2, p1, p2, k3, k4, k5, k6; fisheye: k1, k2, k3, k4, the rest unused.
  std::array<double, 8> distortion{};
  LensModel lens = LensModel::perspective;
};

// A camera given by its lens and sensor, without distortion; the principal point is the image's
// centre, ((w-1)/2, (h-1)/2).
Camera camera_from_sensor(int width, int height, double focal_length, double sensor_width,
                          double sensor_height);

// True when straight lines are straight in the image.
bool is_rectilinear(const Camera& camera);

// The point's pixel, in the image or beside it. Nothing for a point less than 1 mm in front of the
// camera's centre plane, nor for one out of the lens model's reach: a distortion polynomial rises
// only up to some radius, beyond which it would fold points back into the image.
std::optional<Eigen::Vector2d> project(const Camera& camera,
                                       const Eigen::Vector3d& point_in_camera);

// The largest sqrt(x^2 + y^2)/z that has a pixel: as far as the distortion polynomial rises, at
// most the tangent of 89.9 degrees; infinite without distortion. To 1e-12 of itself, on the near
// side.
double reach(const Camera& camera);

// A pixel and how it moves with the point and the lens.
struct Projection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;  // d(pixel)/d(point_in_camera), pixels a metre
  Eigen::Vector2d by_k1;                 // d(pixel)/d(distortion[0])
};

// As project.
std::optional<Projection> project_with_derivative(const Camera& camera,
                                                  const Eigen::Vector3d& point_in_camera);

// The direction (x, y, 1) that projects to the pixel, to 1e-10 of its length. Nothing where the
// lens model has none: outside of a fisheye's image circle or beyond 89.9 degrees from its axis,
// and beyond the largest radius to which a distortion polynomial rises.
std::optional<Eigen::Vector3d> ray_through(const Camera& camera, const Eigen::Vector2d& pixel);

// True when the pixel lies on the image, its outermost half pixels included.
bool in_image(const Camera& camera, const Eigen::Vector2d& pixel);

}  // namespace tagsmith::detail
