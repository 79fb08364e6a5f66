// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/centerline.hpp"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"

using namespace tagsmith::detail;

namespace {

struct NamedLine {
  std::string name;
  Centerline line;
};

const Eigen::Vector3d kStart(2.0, 1.0, -3.0);

// Curvatures are far from closing a circle, so that every place has one address.
std::vector<NamedLine> named_lines() {
  const double right = 1.0 / 8.0;
  const double left = -1.0 / 15.0;
  return {
      {"line", Centerline(kStart, 0.4, {{10, 0, 0}})},
      {"graded line", Centerline(kStart, -2.0, {{10, 0, 0.12}})},
      {"right arc", Centerline(kStart, 0, {{2, 0, 0}, {8 * radians(100), right, 0}})},
      {"left arc", Centerline(kStart, 1.0, {{12, left, -0.05}})},
      {"S with grades",
       Centerline(kStart, 3.0, {{5, 0, 0.1}, {6, right, -0.1}, {9, left, 0.05}, {4, 0, 0}})},
  };
}

}  // namespace

TEST_CASE("headings run from +y towards +x") {
  CHECK((direction_of(0) - Eigen::Vector3d(0, 1, 0)).norm() < 1e-15);
  CHECK((direction_of(radians(90)) - Eigen::Vector3d(1, 0, 0)).norm() < 1e-15);
  CHECK((right_of(0) - Eigen::Vector3d(1, 0, 0)).norm() < 1e-15);
}

TEST_CASE("a quarter of a right arc ends where the drawing board says") {
  const Centerline line({2, 1, 0}, 0, {{2, 0, 0}, {8 * radians(90), 1.0 / 8, 0}});
  const CenterlinePoint end = line.at(line.length());
  CHECK((end.position - Eigen::Vector3d(2 + 8, 1 + 2 + 8, 0)).norm() < 1e-12);
  CHECK(end.heading == doctest::Approx(radians(90)));
}

TEST_CASE("a left arc is a right arc in the mirror") {
  const Centerline right({0, 0, 0}, 0, {{9, 0.1, 0}});
  const Centerline left({0, 0, 0}, 0, {{9, -0.1, 0}});
  for (double chainage = -1; chainage < 11; chainage += 0.5) {
    const Eigen::Vector3d a = right.at(chainage).position;
    const Eigen::Vector3d b = left.at(chainage).position;
    CHECK((a - Eigen::Vector3d(-b.x(), b.y(), b.z())).norm() < 1e-12);
  }
}

TEST_CASE("the position's derivative is the heading, and its rise the grade") {
  for (const auto& [name, line] : named_lines()) {
    CAPTURE(name);
    constexpr double kStep = 1e-5;
    for (double chainage = 0.013; chainage < line.length(); chainage += 0.37) {
      CAPTURE(chainage);
      const Eigen::Vector3d slope =
          (line.at(chainage + kStep).position - line.at(chainage - kStep).position) / (2 * kStep);
      const CenterlinePoint point = line.at(chainage);
      CHECK((slope.head<2>() - direction_of(point.heading).head<2>()).norm() < 1e-6);
      CHECK(slope.z() == doctest::Approx(point.grade).epsilon(1e-6));
    }
  }
}

TEST_CASE("the line is continuous from before its start to beyond its end") {
  for (const auto& [name, line] : named_lines()) {
    CAPTURE(name);
    constexpr double kStep = 1e-3;
    for (double chainage = -1; chainage < line.length() + 1; chainage += kStep) {
      const CenterlinePoint here = line.at(chainage);
      const CenterlinePoint next = line.at(chainage + kStep);
      REQUIRE((next.position - here.position).norm() < 1.1 * kStep);
      REQUIRE(std::abs(next.heading - here.heading) < 0.2 * kStep);
    }
  }
}

TEST_CASE("a place found again has the chainage and offset it was made with") {
  constexpr unsigned kSeed = 31;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> across(-3, 3);
  for (const auto& [name, line] : named_lines()) {
    CAPTURE(name);
    std::uniform_real_distribution<double> along(-2, line.length() + 2);
    for (int i = 0; i < 300; ++i) {
      const double chainage = along(random);
      const double offset = across(random);
      CAPTURE(chainage);
      CAPTURE(offset);
      const CenterlinePoint point = line.at(chainage);
      const Eigen::Vector3d place = point.position + offset * right_of(point.heading);
      const CenterlineAddress address = line.locate(place.head<2>());
      CHECK(address.chainage == doctest::Approx(chainage).epsilon(1e-9));
      CHECK(address.offset == doctest::Approx(offset).epsilon(1e-9));
    }
  }
}

TEST_CASE("a place beyond half a turn of a bend is found on the bend") {
  for (const double curvature : {1.0 / 8, -1.0 / 8}) {
    const Centerline line(kStart, 0.4, {{8 * radians(300), curvature, 0}});
    for (double chainage = 1; chainage < line.length(); chainage += 2) {
      CAPTURE(chainage);
      const CenterlinePoint point = line.at(chainage);
      const double inside = curvature > 0 ? 1 : -1;
      const Eigen::Vector3d place = point.position + inside * right_of(point.heading);
      CHECK(line.locate(place.head<2>()).chainage == doctest::Approx(chainage).epsilon(1e-9));
    }
  }
}

TEST_CASE("the places where elements meet are found, too") {
  for (const auto& [name, line] : named_lines()) {
    CAPTURE(name);
    double chainage = 0;
    for (const CenterlineElement& element : line.elements()) {
      const CenterlineAddress address = line.locate(line.at(chainage).position.head<2>());
      CHECK(address.chainage == doctest::Approx(chainage).epsilon(1e-9));
      CHECK(std::abs(address.offset) < 1e-9);
      chainage += element.length;
    }
  }
}

TEST_CASE("nothing on a line of many elements is nearer than the place located") {
  constexpr unsigned kSeed = 32;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> curvature(-0.15, 0.15);
  std::vector<CenterlineElement> elements;
  for (int i = 0; i < 12; ++i) {
    elements.push_back({4, i % 3 == 0 ? 0 : curvature(random), 0});
  }
  const Centerline line({0, 0, 0}, 0, elements);
  std::uniform_real_distribution<double> coordinate(-30, 50);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2d point(coordinate(random), coordinate(random));
    const CenterlineAddress address = line.locate(point);
    const double found = (line.at(address.chainage).position.head<2>() - point).norm();
    for (double chainage = -20; chainage < line.length() + 20; chainage += 0.05) {
      REQUIRE((line.at(chainage).position.head<2>() - point).norm() > found - 1e-9);
    }
  }
}
