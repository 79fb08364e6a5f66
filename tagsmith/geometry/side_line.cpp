// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/side_line.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {

Eigen::Vector3d point_beside(const Centerline& line, double chainage, double offset) {
  const CenterlinePoint point = line.at(chainage);
  return point.position + offset * right_of(point.heading);
}

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Chainages within (from, to) where the center line's elements meet.
std::vector<double> joints(const Centerline& line, double from, double to) {
  std::vector<double> chainages;
  double joint = 0;
  for (const CenterlineElement& element : line.elements()) {
    if (joint > from && joint < to) chainages.push_back(joint);
    joint += element.length;
  }
  if (joint > from && joint < to) chainages.push_back(joint);
  return chainages;
}

// Pieces for an arc of this curvature (of the side line's center line) and length.
int pieces_of(double curvature, double greatest_offset, double length, double sag) {
  if (curvature == 0) return 1;
  constexpr double kMost = 1e5;
  const double radius = 1 / std::abs(curvature) + greatest_offset;
  const double turned = length * std::abs(curvature);
  const double least_turn = std::sqrt(8 * sag / radius);  // sag = R (1 - cos(turn / 2))
  return static_cast<int>(std::clamp(std::ceil(turned / least_turn), 1.0, kMost));
}

// Where the way from a to b passes `position` nearest, as a share of it.
double nearest_share(const Vector2d& a, const Vector2d& b, const Vector2d& position) {
  const Vector2d along = b - a;
  const double square = along.squaredNorm();
  return square > 0 ? std::clamp((position - a).dot(along) / square, 0.0, 1.0) : 0.0;
}

// From a foot on a straight piece to one on the curve, within [low, high].
double refined(const Centerline& line, const ChainageProfile& offset, const Vector2d& position,
               double chainage, double low, double high) {
  const double slope = offset.slope(low, high);
  for (int i = 0; i < 20; ++i) {
    const CenterlinePoint at = line.at(chainage);
    const double aside = offset.at(low) + slope * (chainage - low);
    const Vector2d right = right_of(at.heading).head<2>();
    const Vector2d point = at.position.head<2>() + aside * right;
    const Vector2d tangent =
        (1 - at.curvature * aside) * direction_of(at.heading).head<2>() + slope * right;
    const double square = tangent.squaredNorm();
    if (square == 0) break;
    const double next = std::clamp(chainage + (position - point).dot(tangent) / square, low, high);
    const bool settled = std::abs(next - chainage) < 1e-12;
    chainage = next;
    if (settled) break;
  }
  return chainage;
}

}  // namespace

double side_heading(const Centerline& line, const ChainageProfile& offset, double chainage,
                    double span) {
  const CenterlinePoint point = line.at(chainage);
  if (offset.is_constant()) return point.heading;
  const double slope = offset.slope(chainage - span / 2, chainage + span / 2);
  return point.heading + std::atan2(slope, 1 - point.curvature * offset.at(chainage));
}

double side_roughness(const ChainageProfile& offset, double span) {
  constexpr double kStretch = 8;       // boards
  constexpr std::size_t kPlaces = 28;  // in a row: beside the end of a bay, fewer than half
  constexpr double kSigmas = 0.6745;   // within which half of normal values lie
  constexpr double kShare = 0.8;
  constexpr double kSigmasOfShare = 1.2816;
  constexpr double kMostPlaces = 1e5;
  const double first = offset.stations().front().chainage;
  const double last = offset.stations().back().chainage;
  const double half = kStretch * span / 2;
  const double step = std::max(span, (last - first) / kMostPlaces);
  std::vector<double> turns;
  for (double at = first + half; at + half <= last; at += step) {
    turns.push_back(std::abs(std::atan(offset.slope(at - span / 2, at + span / 2)) -
                             std::atan(offset.slope(at - half, at + half))));
  }
  if (turns.empty()) return 0;
  std::vector<double> all = turns;
  double greatest = quantile(all, kShare) / kSigmasOfShare;
  for (std::size_t begin = 0; begin < turns.size(); begin += kPlaces / 4) {
    const std::size_t end = std::min(begin + kPlaces, turns.size());
    std::vector<double> part(turns.begin() + static_cast<std::ptrdiff_t>(begin),
                             turns.begin() + static_cast<std::ptrdiff_t>(end));
    greatest = std::max(greatest, quantile(part, 0.5) / kSigmas);
    if (end == turns.size()) break;
  }
  return greatest;
}

std::vector<SidePoint> side_points(const Centerline& line, const ChainageProfile& offset,
                                   double from, double to, double sag) {
  std::vector<double> ends = joints(line, from, to);
  std::ranges::copy(offset.breaks(from, to), std::back_inserter(ends));
  ends.push_back(to);
  std::ranges::sort(ends);
  std::vector<SidePoint> points{{from, point_beside(line, from, offset.at(from))}};
  double start = from;
  for (const double end : ends) {
    if (end <= start) continue;
    const double curvature = line.at((start + end) / 2).curvature;
    const double low = offset.at(start);
    const double high = offset.before(end);
    const int pieces =
        pieces_of(curvature, std::max(std::abs(low), std::abs(high)), end - start, sag);
    for (int i = 1; i <= pieces; ++i) {
      const double share = static_cast<double>(i) / pieces;
      const double chainage = i == pieces ? end : start + share * (end - start);
      points.push_back({chainage, point_beside(line, chainage, low + share * (high - low))});
    }
    if (offset.at(end) != high && end < to) {
      points.push_back({end, point_beside(line, end, offset.at(end))});
    }
    start = end;
  }
  return points;
}

Vector2d nearest_on_side(const Centerline& line, const ChainageProfile& offset,
                         const Vector2d& position) {
  constexpr double kSag = 0.002;
  const double abreast = line.locate(position).chainage;
  const double away = (point_beside(line, abreast, offset.at(abreast)).head<2>() - position).norm();
  const double reach = 2 * away + 0.1;  // chainages count on the center line: arcs stretch them
  const std::vector<SidePoint> points =
      side_points(line, offset, abreast - reach, abreast + reach, kSag);
  Vector2d nearest(0, 0);
  double chainage = 0;
  double low = 0;  // of the piece that it lies on
  double high = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector2d from = points[i - 1].position.head<2>();
    const Vector2d to = points[i].position.head<2>();
    const double share = nearest_share(from, to, position);
    const Vector2d foot = from + share * (to - from);
    const double distance = (foot - position).norm();
    if (distance >= least) continue;
    least = distance;
    nearest = foot;
    low = points[i - 1].chainage;
    high = points[i].chainage;
    chainage = low + share * (high - low);
  }
  if (low >= high || line.at((low + high) / 2).curvature == 0) return nearest;
  chainage = refined(line, offset, position, chainage, low, high);
  const double share = (chainage - low) / (high - low);
  const double aside = offset.at(low) + share * (offset.before(high) - offset.at(low));
  return point_beside(line, chainage, aside).head<2>();
}

}  // namespace tagsmith::detail
