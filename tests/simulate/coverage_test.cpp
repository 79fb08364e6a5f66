// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/coverage.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace tagsmith::detail {
namespace {

using Eigen::Vector2d;

double area_of(const std::vector<Vector2d>& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return twice / 2;
}

// The polygon's part with normal . x <= limit.
std::vector<Vector2d> cut(const std::vector<Vector2d>& polygon, const Vector2d& normal,
                          double limit) {
  std::vector<Vector2d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    const double at_a = normal.dot(a) - limit;
    const double at_b = normal.dot(b) - limit;
    if (at_a <= 0) kept.push_back(a);
    if ((at_a <= 0) != (at_b <= 0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return kept;
}

// The area of the polygon within one cell by clipping: another way to the same number.
double clipped_area(std::vector<Vector2d> polygon, int x, int y) {
  polygon = cut(polygon, {1, 0}, x + 1);
  polygon = cut(polygon, {-1, 0}, -x);
  polygon = cut(polygon, {0, 1}, y + 1);
  polygon = cut(polygon, {0, -1}, -y);
  return area_of(polygon);
}

std::vector<Vector2d> quad(std::mt19937& random, double low, double high) {
  std::uniform_real_distribution<double> place(low, high);
  const Vector2d centre(place(random), place(random));
  std::uniform_real_distribution<double> size(0.3, 12);
  std::uniform_real_distribution<double> turn(0, 1.2);
  const double start = turn(random);
  std::vector<Vector2d> corners;
  for (int i = 0; i < 4; ++i) {
    const double angle = start + 1.5 * i;
    corners.push_back(centre + size(random) * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

TEST_CASE("Each cell holds the polygon's exact area, also where the grid cuts it off") {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<Vector2d> polygon = quad(random, -4, 20);
    CoverageGrid grid(16, 13);
    grid.add(polygon, 1);
    grid.integrate();
    for (int y = 0; y < grid.height(); ++y) {
      for (int x = 0; x < grid.width(); ++x) {
        const double expected = clipped_area(polygon, x, y);
        const double found = static_cast<double>(grid.row(y)[x]);
        if (std::abs(found - expected) < 2e-5) continue;
        CAPTURE(trial);
        CAPTURE(x);
        CAPTURE(y);
        CHECK(found == doctest::Approx(expected));
      }
    }
  }
}

TEST_CASE("Weights add and opposite directions cancel") {
  const std::vector<Vector2d> square{{1.25, 1.5}, {3.5, 1.5}, {3.5, 2.5}, {1.25, 2.5}};
  const std::vector<Vector2d> backwards(square.rbegin(), square.rend());
  CoverageGrid grid(5, 4);
  grid.add(square, 2);
  grid.add(square, 1);
  grid.add(backwards, 1);
  grid.integrate();
  CHECK(grid.row(1)[1] == doctest::Approx(2 * 0.75 * 0.5));
  CHECK(grid.row(2)[2] == doctest::Approx(2 * 0.5));
  CHECK(grid.row(2)[3] == doctest::Approx(2 * 0.25));
  CHECK(grid.row(2)[4] == doctest::Approx(0));
  grid.clear();
  grid.integrate();
  CHECK(grid.row(1)[1] == 0);
}

}  // namespace
}  // namespace tagsmith::detail
