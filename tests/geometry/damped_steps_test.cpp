// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/damped_steps.hpp"

#include <algorithm>
#include <limits>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

namespace {

struct Equations {
  Eigen::Matrix2d matrix;
  Eigen::Vector2d right;
  double cost = 0;
};

// Rosenbrock 1960: a curved valley with its floor's lowest place at (1, 1).
Equations valley(const Eigen::Vector2d& p) {
  const Eigen::Vector2d residual(10 * (p[1] - p[0] * p[0]), 1 - p[0]);
  Eigen::Matrix2d by_p;
  by_p << -20 * p[0], 10, -1, 0;
  return {by_p.transpose() * by_p, -by_p.transpose() * residual, residual.squaredNorm()};
}

}  // namespace

TEST_CASE("damped steps find the lowest place of a curved valley") {
  Eigen::Vector2d p(-1.2, 1);
  const Equations found = minimise_damped(p, {100, 1e-12}, valley, [](const Eigen::Vector2d&) {});
  CHECK((p - Eigen::Vector2d(1, 1)).norm() < 1e-4);
  CHECK(found.cost < 1e-8);
}

TEST_CASE("damped steps stay where the parameters mean something") {
  Eigen::Vector2d p(-1.2, 1);
  minimise_damped(p, {100, 1e-12}, valley,
                  [](Eigen::Vector2d& at) { at[0] = std::min(at[0], 0.5); });
  CHECK(p[0] <= 0.5);
  CHECK(p[0] == doctest::Approx(0.5));
  CHECK(p[1] == doctest::Approx(0.25).epsilon(1e-3));
}

TEST_CASE("no step is taken that gains nothing") {
  Eigen::Vector2d p(3, 4);
  const auto everywhere_worse = [start = p](const Eigen::Vector2d& at) {
    return Equations{Eigen::Matrix2d::Identity(), Eigen::Vector2d::Ones(),
                     at == start ? 1 : std::numeric_limits<double>::quiet_NaN()};
  };
  const Equations found =
      minimise_damped(p, {100, 1e-12}, everywhere_worse, [](const Eigen::Vector2d&) {});
  CHECK(p == Eigen::Vector2d(3, 4));
  CHECK(found.cost == 1);
}

TEST_CASE("where equations have no solution the parameters stay as they are") {
  Eigen::Vector2d p(3, 4);
  const auto singular = [](const Eigen::Vector2d& at) {
    return Equations{Eigen::Matrix2d::Constant(std::numeric_limits<double>::quiet_NaN()),
                     Eigen::Vector2d::Ones(), at.allFinite() ? 1.0 : 0.0};
  };
  minimise_damped(p, {100, 1e-12}, singular, [](const Eigen::Vector2d&) {});
  CHECK(p == Eigen::Vector2d(3, 4));
}

TEST_CASE("a step that promises no more than it has to gain is the last, and is not looked at") {
  // Near the lowest place rounding makes every other one a little worse.
  Eigen::Vector2d p(1e-9, 0);
  int asked = 0;
  const auto bowl = [&](const Eigen::Vector2d& at) {
    ++asked;
    return Equations{Eigen::Matrix2d::Identity(), -at, asked == 1 ? 1.0 : 1.0 + 1e-7};
  };
  minimise_damped(p, {100, 1e-6}, bowl, [](const Eigen::Vector2d&) {});
  CHECK(asked == 1);
  CHECK(p.norm() < 1e-11);
}
