// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/draft/fit_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
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

namespace {

struct Drive {
  std::string name;
  std::vector<CenterlineElement> elements;
};

std::vector<CenterlineElement> with_transition() {
  std::vector<CenterlineElement> elements{{15, 0, 0}};
  for (const CenterlineElement& arc : arcs_of_clothoid(9.5, 0, 1 / 12.0, 1)) {
    elements.push_back(arc);
  }
  elements.push_back({10, 1 / 12.0, 0});
  elements.push_back({15, 0, 0});
  return elements;
}

constexpr double kHalfWidth = 2;
constexpr double kPlateHalf = 0.165;

// P of plates every `pitch` metres on both walls, measured with `noise` metres.
std::vector<PlanPoint> surveyed_plates(const Centerline& line, double noise, std::mt19937& random,
                                       double pitch = 2) {
  std::normal_distribution<double> error(0, noise);
  std::vector<PlanPoint> points;
  for (const int side : {-1, 1}) {
    for (double chainage = 1; chainage < line.length() - 0.5; chainage += pitch) {
      const CenterlinePoint at = line.at(chainage);
      const Eigen::Vector3d from_line =
          side * (kHalfWidth * right_of(at.heading) + kPlateHalf * direction_of(at.heading));
      const Eigen::Vector2d noise_of_p(error(random), error(random));
      points.push_back(
          {(at.position + from_line).head<2>() + noise_of_p, side, kPlateHalf, {}, points.size()});
    }
  }
  return points;
}

// Of the wall where the plate with this P touches it.
double heading_beside(const Centerline& line, const PlanPoint& plate) {
  double heading = line.at(line.locate(plate.p).chainage).heading;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d middle =
        plate.p - plate.side * kPlateHalf * direction_of(heading).head<2>();
    heading = line.at(line.locate(middle).chainage).heading;
  }
  return heading;
}

// The plates' greatest turn from where they hang, in standard deviations: as stated, and of plates
// hung by eye.
double worst_turn(const PlanFit& fit, const Centerline& line,
                  const std::vector<PlanPoint>& plates) {
  const double stated = std::hypot(radians(0.3), fit.heading_sigma);
  double worst = 0;
  for (const PlanPoint& plate : plates) {
    const double off = heading_beside(fit.line, plate) - heading_beside(line, plate);
    worst = std::max(worst, std::abs(std::remainder(off, 2 * std::numbers::pi)) / stated);
  }
  return worst;
}

}  // namespace

TEST_CASE("the walls' direction at plates is right within its stated accuracy") {
  std::mt19937 random(1);
  for (const Drive& drive :
       {Drive{"straight", {{40, 0, 0}}},
        Drive{"bend", {{15, 0, 0}, {12 * radians(60), 1 / 12.0, 0}, {15, 0, 0}}},
        Drive{"short line before a bend", {{2, 0, 0}, {8 * radians(90), 1 / 8.0, 0}}},
        Drive{"wide bend", {{20, 0, 0}, {20, 1 / 150.0, 0}, {20, 0, 0}}},
        Drive{"both ways", {{15, 0, 0}, {15, 1 / 30.0, 0}, {15, -1 / 20.0, 0}, {15, 0, 0}}},
        Drive{"transition", with_transition()}}) {
    CAPTURE(drive.name);
    const Centerline line({10, 20, 0}, radians(30), drive.elements);
    for (const double noise : {0.0005, 0.003}) {
      CAPTURE(noise);
      const std::vector<PlanPoint> plates = surveyed_plates(line, noise, random);
      const auto fit = fit_plan(plates, 0.03, 12);
      REQUIRE(fit);
      CHECK(fit->heading_sigma < radians(3));
      CHECK(worst_turn(*fit, line, plates) < 3);
    }
  }
}

// What only one pair shows is weighed against a slip of one of its points.
TEST_CASE("a single pair before a bend says its direction within its stated accuracy") {
  const Centerline line({10, 20, 0}, radians(30), {{2, 0, 0}, {8 * radians(90), 1 / 8.0, 0}});
  for (unsigned seed = 0; seed < 12; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    const std::vector<PlanPoint> plates = surveyed_plates(line, 0.002, random);
    const auto fit = fit_plan(plates, 0.03, 12);
    REQUIRE(fit);
    CHECK(fit->heading_sigma < radians(4));
    CHECK(worst_turn(*fit, line, plates) < 3);
  }
}

TEST_CASE("lists of a few tags far apart say the walls' direction within their stated accuracy") {
  for (unsigned seed = 0; seed < 40; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    const auto within = [&](double from, double to) {
      return std::uniform_real_distribution<double>(from, to)(random);
    };
    const double first = within(12, 30), second = within(12, 30), turn = seed % 2 == 0 ? 1 : -1;
    const Centerline line({10, 20, 0}, radians(30),
                          {{first, 0, 0}, {second, turn / within(15, 80), 0}, {15, 0, 0}});
    const std::vector<PlanPoint> plates = surveyed_plates(line, 0.003, random, 6);
    const auto fit = fit_plan(plates, 0.03, 12);
    REQUIRE(fit);
    for (const double residual : fit->residuals) CHECK(std::abs(residual) < 0.03);
    CHECK(worst_turn(*fit, line, plates) < 3);
  }
}

TEST_CASE("where one wall is surveyed for a part of the drive, the other shows its shape") {
  const Centerline line({10, 20, 0}, radians(30), {{30, 0, 0}, {26, -1 / 25.0, 0}, {20, 0, 0}});
  std::mt19937 random(1);
  std::normal_distribution<double> error(0, 0.003);
  std::vector<PlanPoint> walls;
  for (int i = 1; i < 60; ++i) {
    for (const int side : {-1, 1}) {
      if (side == -1 && i > 17) continue;
      const CenterlinePoint at = line.at(i);
      const Eigen::Vector2d p = (at.position + 2.1 * side * right_of(at.heading)).head<2>();
      walls.push_back({{p.x() + error(random), p.y() + error(random)}, side, 0, {}, walls.size()});
    }
  }
  const auto fit = fit_plan(walls, 0.03, 12);
  REQUIRE(fit);
  CHECK(fit->line.elements().size() == 3);
  CHECK(std::abs(1 / fit->line.elements()[1].curvature) == doctest::Approx(25).epsilon(0.01));
}

TEST_CASE("one slip of the last tag of a bend bends the drive no further") {
  const Centerline line({10, 20, 0}, radians(30), {{8 * radians(100), -1 / 8.0, 0}, {15, 0, 0}});
  for (const double slip : {0.008, 0.012, 0.02}) {
    CAPTURE(slip);
    for (unsigned seed = 0; seed < 8; ++seed) {
      CAPTURE(seed);
      std::mt19937 random(seed);
      std::vector<PlanPoint> plates = surveyed_plates(line, 0.001, random);
      const CenterlinePoint end = line.at(line.length());
      plates.back().p += slip * right_of(end.heading).head<2>();
      const auto fit = fit_plan(plates, 0.03, 12);
      REQUIRE(fit);
      for (const PlanPoint& plate : plates) {
        const double off = std::remainder(
            heading_beside(fit->line, plate) - heading_beside(line, plate), 2 * std::numbers::pi);
        CHECK(std::abs(off) < 3 * std::hypot(radians(0.3), fit->heading_sigma));
      }
    }
  }
}

TEST_CASE("a slip within the tolerance does not bend the drive") {
  const Centerline line({10, 20, 0}, radians(30), {{40, 0, 0}});
  std::mt19937 random(1);
  std::vector<PlanPoint> plates = surveyed_plates(line, 0.001, random);
  plates[plates.size() / 2 - 1].p += Eigen::Vector2d(0.02, 0.015);  // the last left one
  const auto fit = fit_plan(plates, 0.03, 12);
  REQUIRE(fit);
  REQUIRE(fit->line.elements().size() == 1);
  CHECK(std::abs(fit->line.at(0).heading - radians(30)) < radians(0.02));
}
