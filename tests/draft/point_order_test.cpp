// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/point_order.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

namespace tagsmith::detail {
namespace {

SurveyedPoint point_at(double x, double y, PointKind kind = PointKind::left_wall) {
  SurveyedPoint point;
  point.kind = kind;
  point.in_grid = {x, y, 0};
  return point;
}

// Points along a straight wall at these chainages, named and numbered from 1.
std::vector<SurveyedPoint> wall_at(const std::vector<double>& chainages) {
  std::vector<SurveyedPoint> points;
  for (const double chainage : chainages) {
    points.push_back(point_at(0.6 * chainage, 0.8 * chainage));
    points.back().line = static_cast<int>(points.size());
    points.back().name = std::to_string(points.size());
  }
  return points;
}

// What check_order says to compare with the field book; "in order" where it says nothing.
std::string named(const std::vector<SurveyedPoint>& points) {
  const Result<void> ordered = check_order(points);
  if (ordered) return "in order";
  const std::string& words = ordered.error().message;
  const std::size_t begin = words.find("coordinates of ");
  if (begin == std::string::npos) return "none";
  return words.substr(begin + 15, words.find(" with the field book") - begin - 15);
}

}  // namespace

TEST_CASE("a coordinate with two digits exchanged is named") {
  CHECK(named(wall_at({0, 5, 10, 15, 20})) == "in order");
  CHECK(named(wall_at({0, 5, 50, 15, 20})) == "line 3: point 3 (left wall)");
  CHECK(named(wall_at({0, 50, 10, 15, 20})) == "line 2: point 2 (left wall)");
  CHECK(named(wall_at({0, 50, 10})) == "line 2: point 2 (left wall)");
  CHECK(named(wall_at({50, 5, 10, 15, 20})) == "in order");  // a gap, as far as anybody can tell
}

TEST_CASE("where one of two points may be wrong both are named") {
  CHECK(named(wall_at({0, 5, 1, 15, 20})) ==
        "line 2: point 2 (left wall) or line 3: point 3 (left wall)");
}

TEST_CASE("a list that is in no order has no single culprit") {
  CHECK(named(wall_at({0, 40, 5, 35, 10, 30, 15, 25})) == "none");
}

TEST_CASE("bends, rough walls and points across the floor are in order") {
  std::vector<SurveyedPoint> bend, rough, floor;
  for (int i = 0; i < 30; ++i) {
    const double turn = 0.1 * i;
    bend.push_back(point_at(6 * std::cos(turn), 6 * std::sin(turn)));
    rough.push_back(point_at(0.1 * i, i % 2 == 0 ? 0.0 : 0.25));
    floor.push_back(point_at(0.5 * i, i % 2 == 0 ? -2.0 : 2.0, PointKind::floor));
  }
  // A refuge of 1 m by 2 m with one point at its back, and a hairpin with few points.
  const std::vector<SurveyedPoint> niche{point_at(0, 0), point_at(2, 0), point_at(2.5, 2),
                                         point_at(3, 0), point_at(5, 0)};
  const std::vector<SurveyedPoint> hairpin{point_at(0, 0), point_at(20, 0), point_at(25, 3),
                                           point_at(20, 6), point_at(0, 6)};
  CHECK(named(niche) == "in order");
  CHECK(named(hairpin) == "in order");
  CHECK(named(bend) == "in order");
  CHECK(named(rough) == "in order");
  CHECK(named(floor) == "in order");
}

TEST_CASE("points with chainages come in any order, and each wall is by itself") {
  std::vector<SurveyedPoint> points = wall_at({0, 50, 10});
  for (SurveyedPoint& point : points) point.chainage = point.in_grid.norm();
  CHECK(named(points) == "in order");
  std::vector<SurveyedPoint> walls;
  for (double chainage = 0; chainage < 30; chainage += 5) {
    walls.push_back(point_at(chainage, 0));
    walls.push_back(point_at(30 - chainage, 4, PointKind::right_wall));
  }
  CHECK(named(walls) == "in order");
}

}  // namespace tagsmith::detail
