// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/plate_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tagsmith {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

bool has_distortion(const Camera& camera) {
  return std::ranges::any_of(camera.distortion, [](double k) { return k != 0; });
}

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

// Points of the straight side from one corner to the next, the first one included, close enough
// that the chords between their pictures stay within the accuracy promised: a curve's distance from
// its chord falls with the square of the number of pieces.
void add_side(std::vector<Vector2d>& outline, const Camera& camera, const Vector3d& from,
              const Vector3d& to) {
  constexpr double kAccuracy = 1e-3;  // px
  constexpr int kMostPieces = 256;
  const Vector2d start = *project(camera, from);
  outline.push_back(start);
  if (!has_distortion(camera)) return;
  const Vector2d end = *project(camera, to);
  // Quarter points too: the midpoint of a symmetric S-shaped side lies on its chord.
  double bulge = 0;
  const Vector2d chord = end - start;
  for (const double part : {0.25, 0.5, 0.75}) {
    const Vector2d offset = *project(camera, from + part * (to - from)) - start;
    const double across = chord.x() * offset.y() - chord.y() * offset.x();
    bulge = std::max(bulge, std::abs(across) / std::max(chord.norm(), 1e-9));
  }
  const int pieces =
      std::clamp(static_cast<int>(std::ceil(std::sqrt(4 * bulge / kAccuracy))), 1, kMostPieces);
  for (int i = 1; i < pieces; ++i) {
    outline.push_back(*project(camera, from + (static_cast<double>(i) / pieces) * (to - from)));
  }
}

}  // namespace

ViewingFrustum viewing_frustum(const Camera& camera, double margin_px) {
  constexpr int kSteps =
      16;  // along each border: under distortion the extremes lie between corners
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  ViewingFrustum frustum{kInfinity, -kInfinity, kInfinity, -kInfinity};
  const auto include = [&](double x, double y) {
    const Vector3d ray = ray_through(camera, {x, y});
    frustum.left = std::min(frustum.left, ray.x());
    frustum.right = std::max(frustum.right, ray.x());
    frustum.top = std::min(frustum.top, ray.y());
    frustum.bottom = std::max(frustum.bottom, ray.y());
  };
  for (int i = 0; i <= kSteps; ++i) {
    const double x = -0.5 + camera.width * static_cast<double>(i) / kSteps;
    const double y = -0.5 + camera.height * static_cast<double>(i) / kSteps;
    include(x, -0.5);
    include(x, camera.height - 0.5);
    include(-0.5, y);
    include(camera.width - 0.5, y);
  }
  const double margin_x = margin_px / camera.fx;
  const double margin_y = margin_px / camera.fy;
  return {frustum.left - margin_x, frustum.right + margin_x, frustum.top - margin_y,
          frustum.bottom + margin_y, frustum.nearest};
}

std::vector<Vector2d> outline_in_image(const Camera& camera, const ViewingFrustum& frustum,
                                       const Pose& camera_from_plate, const Rectangle& rectangle) {
  const double right = rectangle.x + rectangle.width;
  const double bottom = rectangle.y + rectangle.height;
  std::vector<Vector3d> corners{camera_from_plate * Vector3d(rectangle.x, rectangle.y, 0),
                                camera_from_plate * Vector3d(right, rectangle.y, 0),
                                camera_from_plate * Vector3d(right, bottom, 0),
                                camera_from_plate * Vector3d(rectangle.x, bottom, 0)};
  corners = clip(std::move(corners), frustum);
  std::vector<Vector2d> outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    add_side(outline, camera, corners[i], corners[(i + 1) % corners.size()]);
  }
  return outline;
}

}  // namespace tagsmith
