// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/point_order.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tagsmith/survey/expected_place.hpp"
#include "tagsmith/survey/passes_over.hpp"

namespace tagsmith::detail {

// ---- Heights.

namespace {

// Against the line through the others, in the order of their chainages.
NeighbourOff off_from(const std::vector<HeightStation>& others, const HeightStation& station) {
  constexpr double kNear = 0.1;  // of the stretch of all
  const double apart = kNear * (others.back().chainage - others.front().chainage);
  std::vector<double> slopes;
  double mean = 0;
  for (std::size_t i = 0; i < others.size(); ++i) {
    mean += others[i].chainage / static_cast<double>(others.size());
    for (std::size_t j = i + 1; j < others.size(); ++j) {
      const double run = others[j].chainage - others[i].chainage;
      if (run > apart) slopes.push_back((others[j].height - others[i].height) / run);
    }
  }
  const double slope = slopes.empty() ? 0 : median(std::move(slopes));
  std::vector<double> heights;
  double squares = 0;
  for (const HeightStation& other : others) {
    heights.push_back(other.height + slope * (station.chainage - other.chainage));
    squares += (other.chainage - mean) * (other.chainage - mean);
  }
  const double beyond = (station.chainage - mean) * (station.chainage - mean);
  return {station.height - median(std::move(heights)),
          beyond > 0 ? std::sqrt(1 + beyond / squares) : 1};
}

}  // namespace

std::vector<NeighbourOff> offs_from_neighbours(const std::vector<HeightStation>& stations) {
  if (stations.size() <= 2 * kNeighboursBeside) return {};
  std::vector<NeighbourOff> offs;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const std::size_t last = stations.size() - 1 - 2 * kNeighboursBeside;
    const std::size_t begin = std::min(i > kNeighboursBeside ? i - kNeighboursBeside : 0, last);
    std::vector<HeightStation> beside;
    for (std::size_t j = begin; j <= begin + 2 * kNeighboursBeside; ++j) {
      if (j != i) beside.push_back(stations[j]);
    }
    offs.push_back(off_from(beside, stations[i]));
  }
  return offs;
}

// ---- Helpers.

double scatter_of(std::vector<double> values) {
  constexpr double kSigmaOfMedian = 1.4826;
  for (double& value : values) value = std::abs(value);
  return kSigmaOfMedian * median(std::move(values));
}

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0;
  return (p - a - share * along).norm();
}

// ---- Order.

namespace {

using Points = std::vector<const SurveyedPoint*>;

Eigen::Vector2d place_of(const SurveyedPoint& point) { return point.in_grid.head<2>(); }

// Whether this point lies before the one before it or beyond the one behind, along the way between
// these, by more than the length of that way plus a metre. Across it walls have niches and bends.
bool is_detour(const Points& points, std::size_t i) {
  constexpr double kRough = 1;  // metres
  const Eigen::Vector2d before = place_of(*points[i - 1]);
  const Eigen::Vector2d way = place_of(*points[i + 1]) - before;
  const double length = way.norm();
  if (length == 0) return false;
  const double along = (place_of(*points[i]) - before).dot(way) / length;
  return std::max(-along, along - length) > length + kRough;
}

std::optional<std::size_t> first_detour(const Points& points) {
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    if (is_detour(points, i)) return i;
  }
  return std::nullopt;
}

double way_along(const Points& points) {
  double way = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    way += (place_of(*points[i]) - place_of(*points[i - 1])).norm();
  }
  return way;
}

// The points near a detour without which there is none: those whose removal leaves about the
// shortest way.
Points culprits(const Points& points, std::size_t detour) {
  constexpr double kAboutAsShort = 1.1;
  struct Culprit {
    const SurveyedPoint* point = nullptr;
    double way = 0;  // along the others
  };
  std::vector<Culprit> found;
  const std::size_t first = detour - std::min<std::size_t>(detour, 2);
  for (std::size_t i = first; i < std::min(detour + 3, points.size()); ++i) {
    Points without = points;
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
    if (!first_detour(without)) found.push_back({points[i], way_along(without)});
  }
  if (found.empty()) return {};
  const double shortest = std::ranges::min_element(found, {}, &Culprit::way)->way;
  Points likely;
  for (const Culprit& culprit : found) {
    if (culprit.way <= kAboutAsShort * shortest) likely.push_back(culprit.point);
  }
  return likely;
}

// A way that comes back near itself, more than a drive's height above: drives are wider than the
// reach, and so are the pillars between the legs of a ramp.
Result<void> check_passing(const Points& points) {
  constexpr double kReach = 1.5;  // metres
  constexpr double kRoom = 2;
  std::vector<Eigen::Vector3d> way;
  for (const SurveyedPoint* point : points) way.push_back(point->in_grid);
  const std::optional<Passing> passing =
      passing_of(way, kReach / 2, kRoom, kReach, [](std::size_t, std::size_t) { return kReach; });
  if (!passing) return {};
  return fail(fmt::format(
      "the drive passes {} itself: near {} it lies {:.1f} m {} where it is near {}; a survey holds "
      "no such drive: make one of each turn, from lists that end before they come to lie {} an "
      "earlier part",
      passing->above > 0 ? "over" : "under", in_words(*points[passing->later]),
      std::abs(passing->above), passing->above > 0 ? "above" : "below",
      in_words(*points[passing->earlier]), passing->above > 0 ? "over" : "under"));
}

std::string names_of(const Points& points) {
  std::vector<std::string> names;
  for (const SurveyedPoint* point : points) names.push_back(in_words(*point));
  return fmt::format("{}", fmt::join(names, " or "));
}

}  // namespace

Result<void> check_order(const std::vector<SurveyedPoint>& points) {
  std::map<PointKind, Points> kinds;
  for (const SurveyedPoint& point : points) {
    const bool runs_along =
        point.kind != PointKind::floor && point.kind != PointKind::roof && !point.tag;
    if (runs_along && !point.chainage && !point.of_alignment) kinds[point.kind].push_back(&point);
  }
  for (const auto& [kind, of_kind] : kinds) {
    const auto detour = first_detour(of_kind);
    if (!detour) {
      if (auto passing = check_passing(of_kind); !passing) return passing;
      continue;
    }
    const Points wrong = culprits(of_kind, *detour);
    const SurveyedPoint& at = *of_kind[*detour];
    return fail(fmt::format(
        "the points of one kind run back at {}; expected in order along the drive; {}",
        in_words(at),
        wrong.empty() ? std::string("list the points of each kind along the drive")
                      : "compare the coordinates of " + names_of(wrong) +
                            " with the field book: without it the others run along the drive"));
  }
  return {};
}

}  // namespace tagsmith::detail
