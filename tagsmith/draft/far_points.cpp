// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/far_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "tagsmith/base/statistics.hpp"
#include "tagsmith/base/text.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMostFar = 3;  // of more, a wrong point each is no longer the likely reason

// Of most points from the one before them in the list, metres, seen from above.
double usual_step(const std::vector<SurveyedPoint>& points) {
  constexpr double kMostOf = 0.9;
  std::vector<double> steps;
  for (std::size_t i = 1; i < points.size(); ++i) {
    steps.push_back((points[i].in_grid - points[i - 1].in_grid).head<2>().norm());
  }
  return quantile(steps, kMostOf);
}

// Points in cubes of a side, to find those near a place.
class Cubes {
 public:
  Cubes(const std::vector<SurveyedPoint>& points, double side) : points_(points), side_(side) {
    for (std::size_t i = 0; i < points.size(); ++i) cubes_[cube_of(points[i])].push_back(i);
  }

  // Whether another point lies nearer than a cube's side.
  bool has_neighbour(std::size_t i) const {
    const Cube middle = cube_of(points_[i]);
    Cube cube = middle;
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      cube[0] = middle[0] + neighbour % 3 - 1;
      cube[1] = middle[1] + neighbour / 3 % 3 - 1;
      cube[2] = middle[2] + neighbour / 9 - 1;
      const auto found = cubes_.find(cube);
      if (found == cubes_.end()) continue;
      const bool near = std::ranges::any_of(found->second, [&](std::size_t other) {
        return other != i && (place_of(points_[other]) - place_of(points_[i])).norm() < side_;
      });
      if (near) return true;
    }
    return false;
  }

 private:
  using Cube = std::array<std::int64_t, 3>;

  static Vector3d place_of(const SurveyedPoint& point) {
    return {point.in_grid.x(), point.in_grid.y(), point.has_height ? point.in_grid.z() : 0};
  }
  Cube cube_of(const SurveyedPoint& point) const {
    const Vector3d place = (place_of(point) / side_).array().floor();
    return {std::llround(place.x()), std::llround(place.y()), std::llround(place.z())};
  }

  const std::vector<SurveyedPoint>& points_;
  double side_;
  std::map<Cube, std::vector<std::size_t>> cubes_;
};

// Nothing where more than a few are far apart.
std::vector<std::size_t> far_points(const std::vector<SurveyedPoint>& points) {
  constexpr double kSteps = 3;
  constexpr double kLeast = 2;  // metres
  const Cubes cubes(points, kSteps * usual_step(points) + kLeast);
  std::vector<std::size_t> far;
  for (std::size_t i = 0; i < points.size() && far.size() <= kMostFar; ++i) {
    if (!points[i].of_alignment && !cubes.has_neighbour(i)) far.push_back(i);
  }
  if (far.size() > kMostFar) far.clear();
  return far;
}

double distance_to_nearest(const SurveyedPoint& point, const std::vector<SurveyedPoint>& others) {
  double least = std::numeric_limits<double>::infinity();
  for (const SurveyedPoint& other : others) {
    const Vector3d apart = point.in_grid - other.in_grid;
    const bool both = point.has_height && other.has_height;
    least = std::min(least, both ? apart.norm() : apart.head<2>().norm());
  }
  return least;
}

// Whether a point may belong to the tunnel or to what continues it.
bool may_belong(const Tunnel& tunnel, const Grid& grid, const SurveyedPoint& point) {
  constexpr double kMostUp = 50;  // metres: higher than rooms of a mine
  const Vector3d p = world_from_grid(grid, point.in_grid);
  const Centerline& line = tunnel.centerline;
  const CenterlineAddress address = line.locate(p.head<2>());
  const double beyond = std::max(-address.chainage, address.chainage - line.length());
  const double up = p.z() - line.at(address.chainage).position.z();
  return std::abs(address.offset) < greatest_width(tunnel) && beyond < line.length() &&
         (!point.has_height || std::abs(up) < kMostUp);
}

}  // namespace

void check_far_points(const std::vector<SurveyedPoint>& points, const Grid& grid,
                      const FitOfPoints& fit, FindingLog& log) {
  if (points.size() < 2) return;
  const std::vector<std::size_t> far = far_points(points);
  if (far.empty()) return;
  std::vector<SurveyedPoint> others = points;
  for (auto i = far.rbegin(); i != far.rend(); ++i) {
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(*i));
  }
  const Result<TunnelFit> without = fit(others);
  if (!without) return;
  for (const std::size_t i : far) {
    const SurveyedPoint& point = points[i];
    if (may_belong(without->tunnel, grid, point)) continue;
    log.error({point.line, 0}, "far-point",
              fmt::format("point {} ({}) lies {} m from the nearest of the others, which make a "
                          "tunnel without it",
                          point.name.substr(0, 60), to_string(point.kind),
                          format_number(distance_to_nearest(point, others), 1)),
              "compare its coordinates with the field book; if the drive leads there, list points "
              "in between");
  }
}

}  // namespace tagsmith::detail
