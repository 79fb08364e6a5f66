// SPDX-License-Identifier: Apache-2.0
#include <random>

#include <doctest/doctest.h>

#include "decoder/ledger/plate_history.hpp"

namespace tagsmith::detail {
namespace {

using doctest::Approx;

// How often the stated interval holds the true day, of lines that fall from `level` by `slope` a
// day, seen on `days` days, 30 apart, with this scatter.
double coverage(std::mt19937& random, int days, double level, double slope, double scatter) {
  constexpr int kTrials = 4000;
  constexpr double kLimit = 0.4;
  std::normal_distribution<double> noise(0, scatter);
  int held = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<TrendPoint> points;
    for (int i = 0; i < days; ++i) {
      const double day = 30.0 * i;
      points.push_back({day, level + slope * day + noise(random)});
    }
    const Trend trend = fit_trend(points).value();
    const double truth = (kLimit - level) / slope;
    const Crossing crossing = crossing_of(trend, kLimit);
    const bool is_after = crossing.earliest && *crossing.earliest <= truth;
    held += is_after && (!crossing.latest || truth <= *crossing.latest) ? 1 : 0;
  }
  return static_cast<double>(held) / kTrials;
}

}  // namespace

TEST_CASE("a line without scatter is at its limit on one day") {
  const auto trend = fit_trend({{0, 0.8}, {10, 0.7}, {20, 0.6}});
  REQUIRE(trend);
  CHECK(trend->slope == Approx(-0.01));
  CHECK(trend->scatter == Approx(0));
  const Crossing crossing = crossing_of(*trend, 0.4);
  CHECK(*crossing.expected == Approx(40));
  CHECK(*crossing.earliest == Approx(40));
  CHECK(*crossing.latest == Approx(40));
}

TEST_CASE("a line with scatter has the interval that is computed by hand") {
  // Slope -5.1 / 5, squares of the residuals 0.018, Student's t of 2 degrees of freedom 1.8856.
  const auto trend = fit_trend({{0, 4}, {1, 3.1}, {2, 1.9}, {3, 1}});
  REQUIRE(trend);
  CHECK(trend->slope == Approx(-1.02));
  CHECK(trend->scatter == Approx(0.094868).epsilon(1e-4));
  const Crossing crossing = crossing_of(*trend, 0);
  CHECK(*crossing.earliest == Approx(3.75369).epsilon(1e-4));
  CHECK(*crossing.expected == Approx(3.95098).epsilon(1e-4));
  CHECK(*crossing.latest == Approx(4.17864).epsilon(1e-4));
}

TEST_CASE("fewer than three days, or one day thrice, have no trend") {
  CHECK_FALSE(fit_trend({}));
  CHECK_FALSE(fit_trend({{0, 1}, {10, 0.9}}));
  CHECK_FALSE(fit_trend({{5, 1}, {5, 0.9}, {5, 0.8}}));
}

TEST_CASE("what does not surely fall has no last day, and what surely rises has none at all") {
  const Crossing level =
      crossing_of(*fit_trend({{0, 0.8}, {10, 0.79}, {20, 0.81}, {30, 0.8}}), 0.4);
  CHECK_FALSE(level.latest);
  REQUIRE(level.earliest);
  CHECK(*level.earliest > 30);
  const Crossing rising = crossing_of(*fit_trend({{0, 0.6}, {10, 0.7}, {20, 0.8}}), 0.4);
  CHECK_FALSE(rising.earliest);
  CHECK_FALSE(rising.expected);
  // So little above the limit that it may be there now.
  const Crossing near = crossing_of(*fit_trend({{0, 0.5}, {10, 0.3}, {20, 0.45}}), 0.4);
  CHECK(*near.earliest == 20);
}

TEST_CASE("the stated interval holds the true day as often as it says") {
  constexpr unsigned kSeed = 3;
  std::mt19937 random(kSeed);
  struct Case {
    int days;
    double scatter;
  };
  // 4000 trials: a standard deviation of 0.0063.
  for (const Case& one : {Case{3, 0.003}, Case{4, 0.02}, Case{6, 0.02}, Case{12, 0.02},
                          Case{12, 0.04}, Case{24, 0.03}}) {
    // At its limit well after the last day, so that no interval is cut off there.
    const double slope = -0.4 / (30.0 * one.days * 1.7);
    const double share = coverage(random, one.days, 0.8, slope, one.scatter);
    CAPTURE(one.days);
    CAPTURE(one.scatter);
    CHECK(share == Approx(kTrendConfidence).epsilon(0.025));
  }
}

}  // namespace tagsmith::detail
