// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/plate_in_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tagsmith::detail {

// ---- Outlines.

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Sutherland and Hodgman 1974, "Reentrant polygon clipping", against normal . x >= limit.
std::vector<Vector3d> clip(const std::vector<Vector3d>& polygon, const Vector3d& normal,
                           double limit) {
  std::vector<Vector3d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d& from = polygon[i];
    const Vector3d& to = polygon[(i + 1) % polygon.size()];
    const double from_inside = normal.dot(from) - limit;
    const double to_inside = normal.dot(to) - limit;
    if (from_inside >= 0) kept.push_back(from);
    if ((from_inside >= 0) != (to_inside >= 0)) {
      kept.push_back(from + from_inside / (from_inside - to_inside) * (to - from));
    }
  }
  return kept;
}

std::vector<Vector3d> clip(std::vector<Vector3d> polygon, const ViewingFrustum& frustum) {
  const std::array<Vector3d, 4> sides{Vector3d(1, 0, -frustum.left), Vector3d(-1, 0, frustum.right),
                                      Vector3d(0, 1, -frustum.top),
                                      Vector3d(0, -1, frustum.bottom)};
  polygon = clip(polygon, Vector3d::UnitZ(), frustum.nearest);
  for (const Vector3d& side : sides) {
    const bool whole =
        std::ranges::all_of(polygon, [&](const Vector3d& corner) { return side.dot(corner) >= 0; });
    if (!whole) polygon = clip(polygon, side, 0);
  }
  return polygon;
}

// The point's pixel; for a point beyond the lens model's reach, that of the nearest one within. The
// visible part of a polygon stays unchanged when its outline is pulled in so.
Vector2d pixel_within_reach(const Camera& camera, double reach, const Vector3d& point_in_camera) {
  if (const auto pixel = project(camera, point_in_camera)) return *pixel;
  const Vector2d ideal = point_in_camera.head<2>() / point_in_camera.z();
  const Vector2d within = (1 - 1e-9) * reach * ideal.normalized();
  return project(camera, {within.x(), within.y(), 1}).value();
}

// Points of the straight side from one corner to the next, the first one included, close enough
// that the chords between their pictures stay within the accuracy promised: a curve's distance from
// its chord falls with the square of the number of pieces.
void add_side(std::vector<Vector2d>& outline, const Camera& camera, double reach,
              const Vector3d& from, const Vector3d& to) {
  constexpr double kAccuracy = 1e-3;  // px
  constexpr int kMostPieces = 1024;
  const auto pixel_at = [&](double part) {
    return pixel_within_reach(camera, reach, from + part * (to - from));
  };
  const Vector2d start = pixel_at(0);
  outline.push_back(start);
  if (is_rectilinear(camera)) return;
  const Vector2d end = pixel_at(1);
  // Quarter points too: the midpoint of a symmetric S-shaped side lies on its chord.
  double bulge = 0;
  const Vector2d chord = end - start;
  for (const double part : {0.25, 0.5, 0.75}) {
    const Vector2d offset = pixel_at(part) - start;
    const double across = chord.x() * offset.y() - chord.y() * offset.x();
    bulge = std::max(bulge, std::abs(across) / std::max(chord.norm(), 1e-9));
  }
  const int pieces =
      std::clamp(static_cast<int>(std::ceil(std::sqrt(4 * bulge / kAccuracy))), 1, kMostPieces);
  for (int i = 1; i < pieces; ++i) outline.push_back(pixel_at(static_cast<double>(i) / pieces));
}

}  // namespace

ViewingFrustum viewing_frustum(const Camera& camera, double margin_px) {
  constexpr int kSteps =
      16;  // along each border: under distortion the extremes lie between corners
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  ViewingFrustum frustum{kInfinity, -kInfinity, kInfinity, -kInfinity, reach(camera)};
  const auto include = [&](double x, double y) {
    frustum.left = std::min(frustum.left, x);
    frustum.right = std::max(frustum.right, x);
    frustum.top = std::min(frustum.top, y);
    frustum.bottom = std::max(frustum.bottom, y);
  };
  const auto include_pixel = [&](double x, double y) {
    const std::optional<Vector3d> ray = ray_through(camera, {x, y});
    if (ray) return include(ray->x(), ray->y());
    include(-frustum.reach, -frustum.reach);
    include(frustum.reach, frustum.reach);
  };
  const double low = -0.5 - margin_px;
  const double right = camera.width - 0.5 + margin_px;
  const double bottom = camera.height - 0.5 + margin_px;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = low + (right - low) * i / kSteps;
    const double y = low + (bottom - low) * i / kSteps;
    include_pixel(x, low);
    include_pixel(x, bottom);
    include_pixel(low, y);
    include_pixel(right, y);
  }
  return frustum;
}

std::vector<Vector2d> outline_in_image(const Camera& camera, const ViewingFrustum& frustum,
                                       const Pose& camera_from_plate, const Rectangle& rectangle) {
  std::vector<Vector3d> corners;
  for (const PlatePoint& corner : corners_of(rectangle)) {
    corners.push_back(camera_from_plate * Vector3d(corner.x, corner.y, 0));
  }
  corners = clip(std::move(corners), frustum);
  std::vector<Vector2d> outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    add_side(outline, camera, frustum.reach, corners[i], corners[(i + 1) % corners.size()]);
  }
  return outline;
}

// ---- Where plates truly are.

namespace {

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
    const std::array<PlatePoint, 4> corners = corners_of(plate.drawing.frame_inner);
    PlateTruth truth;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector3d corner(corners[i].x, corners[i].y, 0);
      truth.corners[i] = project(camera, plate.camera_from_plate * corner);
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
