// SPDX-License-Identifier: Apache-2.0
// The pinhole camera with OpenCV's five-parameter distortion.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

namespace tagsmith {

// Camera frame: x right, y down, z along the optical axis. Pixel (0, 0) is the centre of the upper
// left pixel.
struct Camera {
  int width = 0;   // pixels
  int height = 0;  // pixels
  double fx = 0;   // focal lengths and principal point, pixels
  double fy = 0;
  double cx = 0;
  double cy = 0;
  std::array<double, 5> distortion{};  // k1, k2, p1, p2, k3
};

// A camera given by its lens and sensor, without distortion; the principal point is the image's
// centre, ((w-1)/2, (h-1)/2).
Camera camera_from_sensor(int width, int height, double focal_length, double sensor_width,
                          double sensor_height);

// The point's pixel. Nothing for a point less than 1 mm in front of the camera's centre plane.
std::optional<Eigen::Vector2d> project(const Camera& camera,
                                       const Eigen::Vector3d& point_in_camera);

// A pixel and how it moves with the point.
struct Projection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;  // d(pixel)/d(point_in_camera), pixels a metre
};

// As project.
std::optional<Projection> project_with_derivative(const Camera& camera,
                                                  const Eigen::Vector3d& point_in_camera);

// The direction (x, y, 1) that projects to the pixel; distortion is inverted to 1e-10 by
// fixed-point iteration, which converges for the mild distortion that the five-parameter model
// describes.
Eigen::Vector3d ray_through(const Camera& camera, const Eigen::Vector2d& pixel);

// True when the pixel lies on the image, its outermost half pixels included.
bool in_image(const Camera& camera, const Eigen::Vector2d& pixel);

}  // namespace tagsmith
