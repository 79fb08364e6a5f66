// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/fit_tunnel.hpp"

#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith::detail;

TEST_CASE("an element without floor points of its own has its neighbour's grade") {
  constexpr double kGrade = 0.05;
  const std::vector<CenterlineElement> elements{
      {10, 0, kGrade}, {0.02, 0, kGrade}, {12, 1 / 20.0, kGrade}};
  const Centerline line({10, 20, 5}, radians(30), elements);
  std::vector<SurveyedPoint> points;
  const auto add = [&](PointKind kind, double chainage, double offset, double up) {
    const CenterlinePoint at = line.at(chainage);
    SurveyedPoint point;
    point.kind = kind;
    point.in_grid = at.position + offset * right_of(at.heading) + Eigen::Vector3d(0, 0, up);
    points.push_back(point);
  };
  for (double chainage = 0; chainage < 22; chainage += 2) {
    add(PointKind::left_wall, chainage, -2, 1);
    add(PointKind::right_wall, chainage, 2, 1);
    const bool is_even = std::lround(chainage / 2) % 2 == 0;
    add(PointKind::floor, chainage + 0.99, 0, is_even ? 0.004 : -0.004);
  }
  TunnelFitOptions options;
  options.roof_height = 3;
  options.alignment = line;
  const auto fit = fit_tunnel(points, Grid{}, test::corridor_template(), options);
  REQUIRE(fit);
  for (const CenterlineElement& element : fit->tunnel.centerline.elements()) {
    CHECK(std::abs(element.grade - kGrade) < 0.002);
  }
}
