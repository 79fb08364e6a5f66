// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/check_points.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/statistics.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/draft/point_order.hpp"
#include "tagsmith/survey/expected_place.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;

Vector2d middle_of(const std::vector<SurveyedPoint>& points) {
  std::vector<double> x;
  std::vector<double> y;
  for (const SurveyedPoint& point : points) {
    x.push_back(point.in_grid.x());
    y.push_back(point.in_grid.y());
  }
  return {median(std::move(x)), median(std::move(y))};
}

// ---- Units.

// At most 200 points of the kinds, seen from above, evenly spread over the list.
std::vector<Vector2d> sample_of(const std::vector<SurveyedPoint>& points, PointKind kind,
                                PointKind other) {
  constexpr std::size_t kMost = 200;
  std::vector<Vector2d> all;
  for (const PointKind wanted : {kind, other}) {
    for (const SurveyedPoint& point : points) {
      if (point.kind == wanted) all.emplace_back(point.in_grid.head<2>());
    }
    if (!all.empty()) break;
  }
  std::vector<Vector2d> sample;
  const std::size_t step = (all.size() + kMost - 1) / kMost;
  for (std::size_t i = 0; i < all.size(); i += step) sample.push_back(all[i]);
  return sample;
}

double distance_to_line(const Vector2d& p, const std::vector<Vector2d>& line) {
  double least = (p - line.front()).norm();
  for (std::size_t i = 1; i < line.size(); ++i) {
    least = std::min(least, distance_to_segment(p, line[i - 1], line[i]));
  }
  return least;
}

std::optional<double> apparent_width(const std::vector<SurveyedPoint>& points) {
  const auto left = sample_of(points, PointKind::left_wall, PointKind::left_tag);
  const auto right = sample_of(points, PointKind::right_wall, PointKind::right_tag);
  if (left.empty() || right.empty()) return std::nullopt;
  std::vector<double> distances;
  for (const Vector2d& p : left) distances.push_back(distance_to_line(p, right));
  return median(std::move(distances));
}

// Of the roof above the nearest floor point.
std::optional<double> apparent_height(const std::vector<SurveyedPoint>& points) {
  constexpr std::size_t kMost = 200;
  std::vector<double> heights;
  for (const SurveyedPoint& roof : points) {
    if (roof.kind != PointKind::roof || heights.size() == kMost) continue;
    double least = std::numeric_limits<double>::infinity();
    double height = 0;
    for (const SurveyedPoint& floor : points) {
      if (floor.kind != PointKind::floor && floor.kind != PointKind::centerline) continue;
      const double away = (floor.in_grid - roof.in_grid).head<2>().norm();
      if (away >= least) continue;
      least = away;
      height = roof.in_grid.z() - floor.in_grid.z();
    }
    if (std::isfinite(least)) heights.push_back(height);
  }
  if (heights.empty()) return std::nullopt;
  return median(std::move(heights));
}

// ---- Slips.

constexpr double kTimesScatter = 8;  // the scatter
constexpr std::size_t kLeastOfKind = 7;

// That of the values beside one of them, of which rock may be rougher than elsewhere; 0 of a few.
double scatter_beside(const std::vector<double>& values, std::size_t place) {
  constexpr std::size_t kBeside = 6;  // on either side
  std::vector<double> beside;
  for (std::size_t i = place - std::min(place, kBeside);
       i < std::min(place + kBeside + 1, values.size()); ++i) {
    if (i != place) beside.push_back(values[i]);
  }
  return beside.size() < kLeastOfKind ? 0 : scatter_of(std::move(beside));
}

struct HeightSlip {
  std::size_t index = 0;
  double off = 0;
  double sigma = 0;  // of the kind's other points
};

// Slips among the stations of one kind, in the order of the drive.
std::vector<HeightSlip> slips_of(const std::vector<HeightStation>& stations) {
  constexpr double kLeastSlip = 0.03;
  constexpr double kAtEnds = 2;  // lines that are prolonged err more
  const std::vector<NeighbourOff> offs = offs_from_neighbours(stations);
  std::vector<double> all;
  for (const NeighbourOff& beside : offs) all.push_back(beside.off / beside.uncertainty);
  const double sigma = scatter_of(std::move(all));
  const double tolerance = std::max(kLeastSlip, kTimesScatter * sigma);
  std::vector<HeightSlip> slips;
  for (std::size_t i = 0; i < offs.size(); ++i) {
    const auto& [off, uncertainty] = offs[i];
    const bool at_end = i < kNeighboursBeside || i + kNeighboursBeside >= stations.size();
    if (std::abs(off) <= std::max(at_end ? kAtEnds : 1, uncertainty) * tolerance) continue;
    slips.push_back({stations[i].index, off, sigma});
  }
  return slips;
}

}  // namespace

void check_exchanged(const std::vector<SurveyedPoint>& points, FindingLog& log) {
  constexpr std::size_t kLeastPoints = 5;
  constexpr double kSlack = 10;  // metres
  if (points.size() < kLeastPoints) return;
  const Vector2d middle = middle_of(points);
  const auto away = [&](double x, double y) { return (Vector2d(x, y) - middle).norm(); };
  std::vector<double> distances;
  for (const SurveyedPoint& point : points) {
    distances.push_back(away(point.in_grid.x(), point.in_grid.y()));
  }
  // Three quarters of the points of an even drive lie within 3/8 of its length.
  std::vector<double> sorted = distances;
  const double reach = quantile(sorted, 0.75);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d& p = points[i].in_grid;
    if (distances[i] <= 3 * reach + kSlack || away(p.y(), p.x()) > 2 * reach + kSlack) continue;
    log.error({points[i].line, 0}, "exchanged-axes",
              fmt::format("point {} lies {} m from the others; with its two coordinates exchanged, "
                          "x = {} and y = {}, it lies among them",
                          points[i].name.substr(0, 60), format_number(distances[i], 0),
                          format_number(p.y(), 3), format_number(p.x(), 3)),
              "exchange east and north of this point");
  }
}

std::optional<std::string> doubt_of_unit(const std::vector<SurveyedPoint>& points,
                                         double metres_per_unit) {
  constexpr double kWidest = 12;
  constexpr double kNarrowest = 0.5;
  constexpr double kWideAndHigh = 7.5;
  const std::optional<double> width = apparent_width(points);
  if (!width) return std::nullopt;
  const std::optional<double> height = apparent_height(points);
  const bool big = *width > kWideAndHigh && height && *height > kWideAndHigh;
  if (*width >= kNarrowest && *width <= kWidest && !big) return std::nullopt;
  const double listed = *width / metres_per_unit;
  return fmt::format(
      "the walls lie {} apart{}: say in which unit the list is, --units m ({} m), ft ({:.2f} m), "
      "us-ft or mm ({:.3f} m)",
      format_number(listed, 2),
      height ? " and the roof " + format_number(*height / metres_per_unit, 2) + " above the floor"
             : "",
      format_number(listed, 2), listed * 0.3048, listed / 1000);
}

void check_heights(const std::vector<SurveyedPoint>& points, const TunnelFit& fit,
                   FindingLog& log) {
  std::map<PointKind, std::vector<HeightStation>> kinds;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].of_alignment) continue;
    const double chainage = fit.residuals[i].chainage;
    const double floor = fit.tunnel.centerline.at(chainage).position.z();
    kinds[points[i].kind].push_back({chainage, points[i].in_grid.z() - floor, i});
  }
  std::vector<HeightStation>& left = kinds[PointKind::left_tag];
  std::vector<HeightStation>& right = kinds[PointKind::right_tag];
  if (std::min(left.size(), right.size()) < kLeastOfKind) {
    std::ranges::move(right, std::back_inserter(left));
    right.clear();
  }
  for (auto& [kind, stations] : kinds) {
    std::ranges::stable_sort(stations, {}, &HeightStation::chainage);
    for (const HeightSlip& slip : slips_of(stations)) {
      const SurveyedPoint& point = points[slip.index];
      log.warning(
          {point.line, 0}, "height-slip",
          fmt::format("point {} ({}) lies {:+.3f} m from the height that its neighbours "
                      "say; the others of its kind scatter by {:.3f} m",
                      point.name.substr(0, 60), to_string(point.kind), slip.off, slip.sigma),
          "measure its height again, or take it out");
    }
  }
}

void check_across(const std::vector<SurveyedPoint>& points, const TunnelFit& fit, FindingLog& log) {
  constexpr double kLeastSlip = 0.003;
  std::vector<double> all;
  std::map<PointKind, std::vector<std::size_t>> kinds;  // points of each; tags of both sides
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!fit.residuals[i].across || points[i].of_alignment) continue;
    all.push_back(*fit.residuals[i].across);
    kinds[is_tag(points[i]) ? PointKind::left_tag : points[i].kind].push_back(i);
  }
  if (all.size() < kLeastOfKind) return;
  for (auto& [kind, of_kind] : kinds) {
    std::ranges::sort(of_kind, {}, [&](std::size_t i) { return fit.residuals[i].chainage; });
    std::vector<double> offs;
    for (const std::size_t i : of_kind) offs.push_back(*fit.residuals[i].across);
    const double usual = scatter_of(offs.size() < kLeastOfKind ? all : offs);
    for (std::size_t k = 0; k < offs.size(); ++k) {
      if (std::abs(offs[k]) <= std::max(kLeastSlip, kTimesScatter * usual)) continue;
      const double sigma = std::max(usual, scatter_beside(offs, k));
      if (std::abs(offs[k]) <= kTimesScatter * sigma) continue;
      const SurveyedPoint& point = points[of_kind[k]];
      log.warning(
          {point.line, 0}, "across-slip",
          fmt::format("point {} ({}) lies {:.1f} mm to the {} of its place in the fitted "
                      "tunnel; the others of its kind scatter by {:.1f} mm",
                      point.name.substr(0, 60), to_string(point.kind), 1000 * std::abs(offs[k]),
                      offs[k] > 0 ? "right" : "left", 1000 * sigma),
          "measure it again, or take it out");
    }
  }
}

}  // namespace tagsmith::detail
