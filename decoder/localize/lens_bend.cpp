// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/lens_bend.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Geometry>

namespace tagsmith {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Line {
  Vector2d point;
  Vector2d direction;
};

// The straight line fitted to the picture of the plate's edge between two rays.
std::optional<Line> line_of_side(const Camera& camera, const Vector3d& from, const Vector3d& to) {
  constexpr int kSamples = 24;
  std::array<Vector2d, kSamples + 1> pixels;
  for (int i = 0; i <= kSamples; ++i) {
    const double part = static_cast<double>(i) / kSamples;
    const auto pixel = project(camera, from + part * (to - from));
    if (!pixel) return std::nullopt;
    pixels[static_cast<std::size_t>(i)] = *pixel;
  }
  const Vector2d start = pixels.front();
  const Vector2d along = (pixels.back() - start).normalized();
  const Vector2d across(-along.y(), along.x());
  // Weighted regression of the distance across on the distance along; weights are lengths.
  double weight = 0;
  double s = 0;
  double n = 0;
  double ss = 0;
  double sn = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const Vector2d middle = (pixels[i] + pixels[i + 1]) / 2 - start;
    const double length = (pixels[i + 1] - pixels[i]).norm();
    const double at = along.dot(middle);
    const double off = across.dot(middle);
    weight += length;
    s += length * at;
    n += length * off;
    ss += length * at * at;
    sn += length * at * off;
  }
  const double slope = (weight * sn - s * n) / (weight * ss - s * s);
  const double offset = (n - slope * s) / weight;
  if (!std::isfinite(slope) || !std::isfinite(offset)) return std::nullopt;
  return Line{start + offset * across, along + slope * across};
}

std::optional<Vector2d> meeting_point(const Line& a, const Line& b) {
  const double sine = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
  if (std::abs(sine) < 1e-3) return std::nullopt;
  const Vector2d between = b.point - a.point;
  const double way = (between.x() * b.direction.y() - between.y() * b.direction.x()) / sine;
  return a.point + way * a.direction;
}

// Where straight lines through the bent sides between these corners meet.
std::optional<std::array<Vector2d, 4>> line_corners_of(const Camera& camera,
                                                       const std::array<Vector2d, 4>& corners) {
  std::array<Vector3d, 4> rays;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto ray = ray_through(camera, corners[i]);
    if (!ray) return std::nullopt;
    rays[i] = *ray;
  }
  std::array<Line, 4> sides;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto side = line_of_side(camera, rays[i], rays[(i + 1) % 4]);
    if (!side) return std::nullopt;
    sides[i] = *side;
  }
  std::array<Vector2d, 4> met;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto point = meeting_point(sides[(i + 3) % 4], sides[i]);
    if (!point) return std::nullopt;
    met[i] = *point;
  }
  return met;
}

}  // namespace

FrameCorners corners_of_bent_sides(const Camera& camera, const FrameCorners& line_corners) {
  if (is_rectilinear(camera)) return line_corners;
  std::array<Vector2d, 4> given;
  for (std::size_t i = 0; i < 4; ++i) given[i] = {line_corners[i].x, line_corners[i].y};
  std::array<Vector2d, 4> corners = given;
  constexpr int kIterations = 4;  // each leaves some percent of the bulge's change over the bulge
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const auto met = line_corners_of(camera, corners);
    if (!met) return line_corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] += given[i] - (*met)[i];
  }
  FrameCorners result{};
  for (std::size_t i = 0; i < 4; ++i) result[i] = {corners[i].x(), corners[i].y()};
  return result;
}

}  // namespace tagsmith
