// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/distortion_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Where a lens shows the rays of one angle to its axis.
struct Ring {
  double radius = 0;  // the mean
  Eigen::Matrix<double, 1, kCameraParameters> by_parameters =
      Eigen::Matrix<double, 1, kCameraParameters>::Zero();
};

// Radii count from `middle`. Opposite directions are averaged, so that a shift of the principal
// point leaves the mean unchanged.
std::optional<Ring> ring_of(const Camera& camera, const Vector2d& middle, double slope) {
  const std::array<Vector2d, 4> directions{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  Ring ring;
  for (const Vector2d& direction : directions) {
    const Vector3d ray(slope * direction.x(), slope * direction.y(), 1);
    const std::optional<Vector2d> pixel = project(camera, ray);
    if (!pixel) return std::nullopt;
    ring.radius += direction.dot(*pixel - middle) / 4;
    ring.by_parameters += direction.transpose() * by_parameters(camera, ray) / 4;
  }
  return ring;
}

double ideal_radius(const Camera& camera, double slope) {
  const double focal = (camera.fx + camera.fy) / 2;
  return focal * (camera.lens == LensModel::fisheye ? std::atan(slope) : slope);
}

// From the middle to the picture's farthest corner.
Vector2d longest_way(const Camera& camera) {
  const Vector2d middle(camera.cx, camera.cy);
  const Vector2d last(camera.width - 1.0, camera.height - 1.0);
  return {2 * middle.x() > last.x() ? -middle.x() : last.x() - middle.x(),
          2 * middle.y() > last.y() ? -middle.y() : last.y() - middle.y()};
}

double seen_radius(const CameraCalibration& calibration) {
  const Vector2d middle(calibration.camera.cx, calibration.camera.cy);
  double radius = 0;
  for (const TagResidual& tag : calibration.residuals) {
    if (!tag.used) continue;
    for (Eigen::Index i = 0; i < 4; ++i) {
      radius = std::max(radius, (tag.seen.segment<2>(2 * i) - middle).norm());
    }
  }
  return radius;
}

}  // namespace

std::optional<std::size_t> runner_up(const CameraCalibration& calibration) {
  std::optional<std::size_t> best;
  const std::string chosen = to_string(calibration.form);
  for (std::size_t i = 0; i < calibration.tried.size(); ++i) {
    if (to_string(calibration.tried[i].form) == chosen) continue;
    if (!best || calibration.tried[i].bic < calibration.tried[*best].bic) best = i;
  }
  return best;
}

DistortionCurve distortion_curve(const CameraCalibration& calibration) {
  constexpr int kSteps = 80;
  const Camera& camera = calibration.camera;
  const Vector2d middle(camera.cx, camera.cy);
  const Vector2d way = longest_way(camera);
  DistortionCurve curve;
  curve.other = runner_up(calibration);
  curve.seen_radius = seen_radius(calibration);
  for (int i = 0; i <= kSteps; ++i) {
    const auto ray = ray_through(camera, middle + way * i / kSteps);
    if (!ray) break;
    const double slope = ray->head<2>().norm();
    const std::optional<Ring> ring = ring_of(camera, middle, slope);
    if (!ring) break;
    DistortionPoint point{ring->radius, ring->radius - ideal_radius(camera, slope)};
    const double variance =
        ring->by_parameters * calibration.covariance * ring->by_parameters.transpose();
    point.sigma = std::sqrt(std::max(0.0, variance));
    if (curve.other) {
      const auto other = ring_of(calibration.tried[*curve.other].camera, middle, slope);
      if (other) point.other = other->radius - ring->radius;
    }
    curve.points.push_back(point);
  }
  return curve;
}

}  // namespace tagsmith::detail
