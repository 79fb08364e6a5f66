// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/camera.hpp"

namespace tagsmith {
namespace {

// OpenCV calib3d, "Detailed description": radial k1, k2, k3 and tangential p1, p2.
Eigen::Vector2d distort(const std::array<double, 5>& k, const Eigen::Vector2d& point) {
  const double x = point.x();
  const double y = point.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  return {x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
          y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y};
}

Eigen::Matrix2d distortion_slope(const std::array<double, 5>& k, const Eigen::Vector2d& point) {
  const double x = point.x();
  const double y = point.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double by_r2 = k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]);
  const double mixed = 2.0 * (x * y * by_r2 + k[2] * x + k[3] * y);
  Eigen::Matrix2d slope;
  slope << radial + 2.0 * x * x * by_r2 + 2.0 * k[2] * y + 6.0 * k[3] * x, mixed,  //
      mixed, radial + 2.0 * y * y * by_r2 + 6.0 * k[2] * y + 2.0 * k[3] * x;
  return slope;
}

Eigen::Vector2d undistort(const std::array<double, 5>& k, const Eigen::Vector2d& distorted) {
  Eigen::Vector2d point = distorted;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Eigen::Vector2d step = distorted - distort(k, point);
    point += step;
    if (step.squaredNorm() < 1e-24) break;
  }
  return point;
}

}  // namespace

Camera camera_from_sensor(int width, int height, double focal_length, double sensor_width,
                          double sensor_height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = focal_length * width / sensor_width;
  camera.fy = focal_length * height / sensor_height;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

std::optional<Eigen::Vector2d> project(const Camera& camera,
                                       const Eigen::Vector3d& point_in_camera) {
  const std::optional<Projection> projection = project_with_derivative(camera, point_in_camera);
  if (!projection) return std::nullopt;
  return projection->pixel;
}

std::optional<Projection> project_with_derivative(const Camera& camera,
                                                  const Eigen::Vector3d& point_in_camera) {
  constexpr double kNearest = 1e-3;
  if (!(point_in_camera.z() >= kNearest)) return std::nullopt;
  const Eigen::Vector2d ideal = point_in_camera.head<2>() / point_in_camera.z();
  const Eigen::Vector2d focal(camera.fx, camera.fy);
  Projection projection;
  projection.pixel =
      focal.cwiseProduct(distort(camera.distortion, ideal)) + Eigen::Vector2d(camera.cx, camera.cy);
  const Eigen::Matrix2d by_ideal = focal.asDiagonal() * distortion_slope(camera.distortion, ideal);
  projection.by_point << by_ideal, -by_ideal * ideal;
  projection.by_point /= point_in_camera.z();
  return projection;
}

Eigen::Vector3d ray_through(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d distorted((pixel.x() - camera.cx) / camera.fx,
                                  (pixel.y() - camera.cy) / camera.fy);
  const Eigen::Vector2d point = undistort(camera.distortion, distorted);
  return {point.x(), point.y(), 1.0};
}

bool in_image(const Camera& camera, const Eigen::Vector2d& pixel) {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= camera.width - 0.5 &&
         pixel.y() <= camera.height - 0.5;
}

}  // namespace tagsmith
