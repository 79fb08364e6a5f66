// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/plate_truth.hpp"

#include <algorithm>
#include <cmath>

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

bool contains(const Rectangle& area, const Vector2d& point) {
  return point.x() >= area.x && point.y() >= area.y && point.x() <= area.x + area.width &&
         point.y() <= area.y + area.height;
}

bool hidden_by_plate(const ScenePlate& other, const Vector3d& point_in_camera) {
  if (!faces_camera(other)) return false;
  const Vector3d ray = point_in_camera / point_in_camera.z();
  const std::optional<double> depth = depth_on_plate(other, ray);
  if (!depth || *depth >= point_in_camera.z()) return false;
  return contains(other.drawing.plate, point_on_plate(other, *depth * ray));
}

bool is_visible(const Camera& camera, std::span<const ScenePlate> plates, std::size_t index,
                const Backdrop* backdrop, const Vector2d& point) {
  const ScenePlate& plate = plates[index];
  if (plate.finish.cover && contains(plate.finish.cover->area, point)) return false;
  const Vector3d point_in_camera = plate.camera_from_plate * Vector3d(point.x(), point.y(), 0);
  const std::optional<Vector2d> pixel = project(camera, point_in_camera);
  if (!pixel || !in_image(camera, *pixel)) return false;
  if (backdrop != nullptr) {
    const int x = std::clamp(static_cast<int>(std::lround(pixel->x())), 0, camera.width - 1);
    const int y = std::clamp(static_cast<int>(std::lround(pixel->y())), 0, camera.height - 1);
    if (static_cast<double>(backdrop->depth.row(y)[x]) < point_in_camera.z()) return false;
  }
  for (std::size_t other = 0; other < plates.size(); ++other) {
    if (other != index && hidden_by_plate(plates[other], point_in_camera)) return false;
  }
  return true;
}

double visible_fraction(const Camera& camera, std::span<const ScenePlate> plates, std::size_t index,
                        const Backdrop* backdrop) {
  constexpr int kColumns = 48;
  constexpr int kRows = 24;
  if (!faces_camera(plates[index])) return 0;
  const Rectangle& frame = plates[index].drawing.frame_outer;
  int visible = 0;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Vector2d point(frame.x + frame.width * (column + 0.5) / kColumns,
                           frame.y + frame.height * (row + 0.5) / kRows);
      if (is_visible(camera, plates, index, backdrop, point)) ++visible;
    }
  }
  return static_cast<double>(visible) / (kColumns * kRows);
}

double module_width_px(const Camera& camera, const ScenePlate& plate) {
  const Vector3d middle = frame_middle_in_camera(plate);
  const Vector3d half = 0.5 * plate.drawing.module * plate.camera_from_plate.rotation.col(0);
  const std::optional<Vector2d> left = project(camera, middle - half);
  const std::optional<Vector2d> right = project(camera, middle + half);
  return left && right ? (*right - *left).norm() : 0.0;
}

}  // namespace

bool faces_camera(const ScenePlate& plate) {
  return plate.camera_from_plate.rotation.col(2).dot(plate.camera_from_plate.translation) > 0;
}

Vector3d frame_middle_in_camera(const ScenePlate& plate) {
  const Rectangle& inner = plate.drawing.frame_inner;
  return plate.camera_from_plate *
         Vector3d(inner.x + inner.width / 2, inner.y + inner.height / 2, 0);
}

std::optional<double> depth_on_plate(const ScenePlate& plate, const Vector3d& ray) {
  const Vector3d normal = plate.camera_from_plate.rotation.col(2);
  const double towards = normal.dot(ray);
  const double offset = normal.dot(plate.camera_from_plate.translation);
  if (std::abs(towards) < 1e-9 * ray.norm() || offset / towards <= 0) return std::nullopt;
  return offset / towards;
}

Vector2d point_on_plate(const ScenePlate& plate, const Vector3d& point_in_camera) {
  const Pose& pose = plate.camera_from_plate;
  return (pose.rotation.transpose() * (point_in_camera - pose.translation)).head<2>();
}

std::vector<PlateTruth> plate_truths(const Camera& camera, std::span<const ScenePlate> plates,
                                     const Backdrop* backdrop) {
  std::vector<PlateTruth> truths;
  for (std::size_t index = 0; index < plates.size(); ++index) {
    const ScenePlate& plate = plates[index];
    const Rectangle& inner = plate.drawing.frame_inner;
    const std::array<Vector3d, 4> corners{
        Vector3d(inner.x, inner.y, 0), Vector3d(inner.x + inner.width, inner.y, 0),
        Vector3d(inner.x + inner.width, inner.y + inner.height, 0),
        Vector3d(inner.x, inner.y + inner.height, 0)};
    PlateTruth truth;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      truth.corners[i] = project(camera, plate.camera_from_plate * corners[i]);
    }
    const Vector3d sight = frame_middle_in_camera(plate).normalized();
    const double cosine = plate.camera_from_plate.rotation.col(2).dot(sight);
    truth.incidence = std::acos(std::clamp(cosine, -1.0, 1.0));
    truth.module_px = module_width_px(camera, plate);
    truth.visible_fraction = visible_fraction(camera, plates, index, backdrop);
    truths.push_back(truth);
  }
  return truths;
}

}  // namespace tagsmith::detail
