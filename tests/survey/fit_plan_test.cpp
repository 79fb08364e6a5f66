// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/fit_plan.hpp"

#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"

using namespace tagsmith::detail;

TEST_CASE("a drive whose points begin in a tight bend is fitted as it is") {
  constexpr double kWidth = 4;
  for (const double radius : {8.0, -8.0, 12.0}) {
    CAPTURE(radius);
    const Centerline line({10, 20, 0}, radians(30), {{8, 1 / radius, 0}, {12, 0, 0}});
    std::vector<PlanPoint> points;
    for (double chainage = 0.5; chainage < 19; chainage += 0.5) {
      const CenterlinePoint at = line.at(chainage);
      const Eigen::Vector2d right(std::cos(at.heading), -std::sin(at.heading));
      for (const int side : {-1, 1}) {
        points.push_back(
            {at.position.head<2>() + side * kWidth / 2 * right, side, 0, {}, points.size()});
      }
    }
    const auto fit = fit_plan(points, 0.01, 6);
    REQUIRE(fit);
    CHECK(fit->width == doctest::Approx(kWidth).epsilon(1e-4));
    for (const double residual : fit->residuals) CHECK(std::abs(residual) < 1e-4);
    const auto& elements = fit->line.elements();
    REQUIRE(elements.size() == 2);
    CHECK(1 / elements[0].curvature == doctest::Approx(radius).epsilon(1e-4));
    CHECK(elements[1].curvature == 0);
  }
}
