// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/ray_sigma.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBelieved = 1e-3;  // weight above which a form must see a ray

RayGrid::Cell& cell_at(RayGrid& grid, const Camera& camera, const Vector2d& pixel) {
  const auto place = [](double at, int size, int count) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>((at + 0.5) / size * count), 0, count - 1));
  };
  const std::size_t column = place(pixel.x(), camera.width, RayGrid::kColumns);
  const std::size_t row = place(pixel.y(), camera.height, RayGrid::kRows);
  return grid.cells[row * RayGrid::kColumns + column];
}

void add_point(RayGrid::Cell& cell, const CameraCalibration& calibration, const Vector2d& pixel) {
  // A fisheye's picture may be a circle in the photo; a perspective lens fills the photo.
  const Camera& camera = calibration.camera;
  if (camera.lens == LensModel::fisheye && !ray_through(camera, pixel)) return;
  cell.has_ray = true;
  const double sigma =
      ray_sigma_px(calibration, pixel).value_or(std::numeric_limits<double>::infinity());
  if (sigma < cell.worst_sigma_px) return;
  cell.worst_sigma_px = sigma;
  cell.worst_pixel = pixel;
}

}  // namespace

std::optional<double> ray_sigma_px(const CameraCalibration& calibration, const Vector2d& pixel) {
  const std::optional<Vector3d> ray = ray_through(calibration.camera, pixel);
  if (!ray) return std::nullopt;
  Matrix2d total = Matrix2d::Zero();
  for (const TriedForm& form : calibration.tried) {
    const std::optional<Vector2d> seen = project(form.camera, *ray);
    if (!seen) {
      if (form.weight > kBelieved) return std::nullopt;
      continue;
    }
    const auto by = by_parameters(form.camera, *ray);
    const Vector2d off = *seen - pixel;
    total += form.weight * (propagated(by, form.covariance) + off * off.transpose());
  }
  return std::sqrt(std::max(0.0, principal_axes(total).values[1]));
}

double RayGrid::worst_sigma_px() const {
  double worst = 0;
  for (const Cell& cell : cells) worst = std::max(worst, cell.worst_sigma_px);
  return worst;
}

RayGrid ray_grid(const CameraCalibration& calibration) {
  constexpr int kPoints = 3;  // of a cell, in each direction
  const Camera& camera = calibration.camera;
  RayGrid grid;
  for (int y = 0; y < RayGrid::kRows * kPoints; ++y) {
    for (int x = 0; x < RayGrid::kColumns * kPoints; ++x) {
      // From border to border.
      const Vector2d pixel(x * (camera.width - 1.0) / (RayGrid::kColumns * kPoints - 1),
                           y * (camera.height - 1.0) / (RayGrid::kRows * kPoints - 1));
      add_point(cell_at(grid, camera, pixel), calibration, pixel);
    }
  }
  for (const TagResidual& tag : calibration.residuals) {
    if (!tag.used) continue;
    for (Eigen::Index i = 0; i < 4; ++i) {
      ++cell_at(grid, camera, tag.seen.segment<2>(2 * i)).corners;
    }
  }
  return grid;
}

double focal_sigma(const CameraCalibration& calibration) {
  double variance = 0;
  for (const TriedForm& form : calibration.tried) {
    const double off = form.camera.fx - calibration.camera.fx;
    variance += form.weight * (form.covariance(0, 0) + off * off);
  }
  return std::sqrt(variance) / calibration.camera.fx;
}

// ---- What a rig states.

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
