// SPDX-License-Identifier: Apache-2.0
// Walls whose distance from the center line changes along the drive.
#include "tagsmith/geometry/side_line.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/observation_model.hpp"

using namespace tagsmith::detail;
using doctest::Approx;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

ChainageProfile bay() {
  return ChainageProfile({{2, 1.9}, {6, 2.1}, {6, 3.0}, {9, 3.0}, {9, 2.0}, {14, 1.8}});
}

Centerline winding() {
  return Centerline({2, 1, 0}, 0.4,
                    {{5.0, 0, 0.02}, {6.0, 1 / 8.0, 0}, {5.0, -1 / 7.0, -0.05}, {2.0, 0, 0}});
}

// The nearest of many points of the line: what the closed search must not miss.
double least_distance(const Centerline& line, const ChainageProfile& offset, const Vector2d& p) {
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](double chainage, double aside) {
    const CenterlinePoint at = line.at(chainage);
    const Vector3d point = at.position + aside * right_of(at.heading);
    least = std::min(least, (point.head<2>() - p).norm());
  };
  for (double chainage = -5; chainage < 24; chainage += 0.002) {
    consider(chainage, offset.at(chainage));
  }
  for (const ProfileStation& station : offset.stations()) {  // corners, and faces of steps
    const double low = offset.before(station.chainage);
    const double step = offset.at(station.chainage) - low;
    for (int i = 0; i <= 1000; ++i) consider(station.chainage, low + i / 1000.0 * step);
  }
  return least;
}

}  // namespace

TEST_CASE("a profile is linear between stations, constant beyond them, and steps where two meet") {
  const ChainageProfile profile = bay();
  CHECK(profile.at(-3) == 1.9);
  CHECK(profile.at(4) == Approx(2.0));
  CHECK(profile.before(6) == Approx(2.1));
  CHECK(profile.at(6) == Approx(3.0));
  CHECK(profile.at(9) == Approx(2.0));
  CHECK(profile.at(99) == Approx(1.8));
  CHECK(profile.slope(3, 5) == Approx(0.05));
  CHECK(profile.slope(5.5, 6.5) == Approx(0.025));  // a step is no slope
  CHECK(profile.slope(4, 6) == Approx(0.05));       // nor is one at the end
  CHECK(profile.steps(5.5, 6.5) == Approx(0.9));
  CHECK(profile.steps(7, 8) == 0);
  CHECK(profile.least(5, 10) == Approx(1.96));
  CHECK(profile.greatest(5, 10) == Approx(3.0));
  CHECK(profile.scaled(-1).least(5, 10) == Approx(-3.0));
  CHECK(profile.greatest(4, 6) == Approx(3.0));  // both sides of a step at the end
  CHECK(profile.least(7, 9) == Approx(2.0));
  CHECK(profile.breaks(2, 9) == std::vector<double>{6});
  CHECK(profile.scaled(-1, 0.5).at(7) == Approx(-2.5));
  CHECK(sum(profile, profile.scaled(-1)).greatest() == Approx(0));
  CHECK(ChainageProfile(2.5).slope(0, 1) == 0);
  CHECK(ChainageProfile(2.5).at(1e9) == 2.5);
}

TEST_CASE("pieces of a side line touch it, and steps stand across it") {
  const Centerline line = winding();
  const ChainageProfile offset = bay();
  constexpr double kSag = 0.001;
  const std::vector<SidePoint> points = side_points(line, offset, -1, 20, kSag);
  CHECK(points.front().chainage == -1);
  CHECK(points.back().chainage == 20);
  int steps = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    CAPTURE(i);
    const double from = points[i - 1].chainage;
    const double to = points[i].chainage;
    CHECK(from <= to);
    if (from == to) {
      ++steps;
      continue;
    }
    const Vector2d a = points[i - 1].position.head<2>();
    const Vector2d b = points[i].position.head<2>();
    for (const double share : {0.0, 0.3, 0.5, 0.9, 1.0}) {
      const double chainage = from + share * (to - from);
      const double aside = share < 1 ? offset.at(chainage) : offset.before(chainage);
      const CenterlinePoint at = line.at(chainage);
      const Vector2d p = (at.position + aside * right_of(at.heading)).head<2>();
      const Vector2d along = (b - a).normalized();
      CHECK(std::abs(along.x() * (p - a).y() - along.y() * (p - a).x()) < 1.5 * kSag);
    }
  }
  CHECK(steps == 2);
}

TEST_CASE("where the last element is a bend, its end is an end of a side line's piece") {
  const Centerline line({0, 0, 0}, 0, {{10, 1 / 8.0, 0}});
  const std::vector<SidePoint> points = side_points(line, ChainageProfile(2), 0, 14, 0.001);
  CHECK(std::ranges::count(points, 10, &SidePoint::chainage) == 1);
  CHECK(side_points(line, ChainageProfile(2), 0, 8, 0.001).back().chainage == 8);
}

TEST_CASE("the distance to a wall that changes is the least one, and its derivative its change") {
  const Centerline line = winding();
  const ChainageProfile right = bay();
  const ChainageProfile left = right.scaled(-1);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> along(0.5, 17.0);
  std::uniform_real_distribution<double> across(-1.2, 1.2);
  for (int i = 0; i < 60; ++i) {
    const CenterlinePoint at = line.at(along(random));
    const Vector3d o = at.position + across(random) * right_of(at.heading) + Vector3d(0, 0, 0.4);
    CAPTURE(o.transpose());
    for (const ChainageProfile* wall : {&left, &right}) {
      const ObservedWall seen = observe_wall(line, *wall, o);
      CHECK(seen.distance == Approx(least_distance(line, *wall, o.head<2>())).epsilon(1e-4));
      CHECK(seen.by_position.norm() == Approx(1));
      // The gradient turns where the nearest point jumps; moving along it must gain what it says.
      const double gained =
          observe_wall(line, *wall, o + 1e-6 * seen.by_position).distance - seen.distance;
      CHECK(gained == Approx(1e-6).epsilon(1e-3));
    }
  }
}

TEST_CASE("a wall said by many equal stations is the wall said by one number") {
  const Centerline line = winding();
  const ChainageProfile many({{0, 1.7}, {3, 1.7}, {8, 1.7}, {20, 1.7}});
  for (double chainage = 0.3; chainage < 17; chainage += 0.7) {
    CAPTURE(chainage);
    const CenterlinePoint at = line.at(chainage);
    const Vector3d o = at.position - 0.5 * right_of(at.heading);
    const ObservedWall one = observe_wall(line, 1.7, o);
    const ObservedWall other = observe_wall(line, many, o);
    CHECK(other.distance == Approx(one.distance).epsilon(1e-9));
    CHECK((other.by_position - one.by_position).norm() < 1e-6);
    CHECK(side_heading(line, many, chainage, 0.4) == Approx(at.heading));
  }
}

TEST_CASE("a board on a wall that opens stands along the wall, also on the outside of a bend") {
  const Centerline line({0, 0, 0}, 0, {{10, 0, 0}, {10, 1 / 20.0, 0}});
  const ChainageProfile opening({{0, 2}, {10, 3}, {20, 3}});
  CHECK(side_heading(line, opening, 5, 0.4) == Approx(std::atan(0.1)));
  CHECK(side_heading(line, opening.scaled(-1), 5, 0.4) == Approx(-std::atan(0.1)));
  CHECK(side_heading(line, opening, 15, 0.4) == Approx(line.at(15).heading));
}

TEST_CASE("rough rock is told from bays and corners") {
  CHECK(side_roughness(2, 0.4) == 0);
  const ChainageProfile bay({{0, 2}, {18, 2}, {20, 3.5}, {30, 3.5}, {32, 2}, {60, 2.2}});
  CHECK(side_roughness(bay, 0.4) < radians(0.05));
  std::vector<ProfileStation> rock;
  for (int i = 0; i < 120; ++i) rock.push_back({0.5 * i, 2 + (i % 2 == 0 ? 0.01 : -0.01)});
  // From one station to the next the wall turns by 2.3 degrees to either side.
  CHECK(side_roughness(ChainageProfile(rock), 0.4) > radians(1.2));
  CHECK(side_roughness(ChainageProfile(rock), 0.4) < radians(2.4));
  // Of a lined drive with rock for a seventh of its length, that of the rock counts.
  std::vector<ProfileStation> lined = rock;
  for (ProfileStation& station : lined) {
    if (station.chainage < 20 || station.chainage > 30) station.value = 2;
  }
  CHECK(side_roughness(ChainageProfile(lined), 0.4) > radians(1));
}
