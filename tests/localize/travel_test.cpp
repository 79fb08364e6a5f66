// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/travel.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace {

Fix fix_at(double x, double y, double heading, double sigma = 0.002) {
  Fix fix;
  fix.survey = "drift";
  fix.position_in_grid = {x, y, 0.3};
  fix.covariance_in_grid = sigma * sigma * Eigen::Matrix3d::Identity();
  fix.attitude = Attitude{heading, 0, 0};
  fix.pose_covariance_in_grid = std::pow(radians(0.05), 2) * PoseCovariance::Identity();
  return fix;
}

// A drive round a bend of 20 m radius, a step of 1 m and a place 0.1 m beside the way at a time,
// its headings turned to the right of it.
std::vector<Fix> drive(std::size_t count, double turned, double sigma = 0.002) {
  std::vector<Fix> fixes;
  for (std::size_t i = 0; i < count; ++i) {
    const double along = 0.05 * static_cast<double>(i);
    const double radius = 20 + (i % 2 == 0 ? 0.05 : -0.05);
    fixes.push_back(
        fix_at(-radius * std::cos(along), radius * std::sin(along), along + turned, sigma));
  }
  return fixes;
}

}  // namespace

TEST_CASE("headings that are turned from the way are told by their angle") {
  for (const double turned : {40.0, -40.0, 85.0, 25.0}) {
    CAPTURE(turned);
    const auto told = turned_headings(drive(8, radians(turned)));
    REQUIRE(told);
    CHECK(degrees(told->angle) == doctest::Approx(turned).epsilon(0.05));
    CHECK(told->steps == 7);
  }
  // Backwards is a way to go, and a camera that is turned by more than a right angle.
  CHECK_FALSE(turned_headings(drive(8, std::numbers::pi)));
  CHECK(degrees(turned_headings(drive(8, radians(110)))->angle) ==
        doctest::Approx(-70).epsilon(0.03));
}

TEST_CASE("headings that differ a little from a way straight on are told with their uncertainty") {
  const auto straight = [](double turned, double beside, double heading_sigma) {
    std::vector<Fix> fixes;
    for (int i = 0; i < 10; ++i) {
      fixes.push_back(fix_at(i % 2 == 0 ? beside : -beside, i, radians(turned)));
      (*fixes.back().pose_covariance_in_grid)(3, 3) = heading_sigma * heading_sigma;
    }
    return course_offset(fixes);
  };
  const double sure = radians(0.05);
  for (const double turned : {1.0, -1.0, 15.0, 0.6}) {
    CAPTURE(turned);
    const auto told = straight(turned, 0.001, sure);
    REQUIRE(told);
    CHECK(degrees(told->angle) == doctest::Approx(turned).epsilon(0.05));
    CHECK(degrees(told->sigma) < 0.15);
    CHECK(told->steps == 9);
  }
  CHECK_FALSE(straight(0.1, 0.001, sure));           // too little to matter
  CHECK_FALSE(straight(1, 0.001, radians(0.5)));     // within what the rig says of its angles
  CHECK_FALSE(straight(1, 0.05, sure));              // not driven straight on
  CHECK_FALSE(straight(40, 0.001, sure));            // turned_headings says more
  CHECK_FALSE(course_offset(drive(8, radians(1))));  // in a bend, the rear axle explains it
}

TEST_CASE("nothing is told of headings that fit, nor of few, short or uncertain steps") {
  CHECK_FALSE(turned_headings(drive(8, 0)));
  CHECK_FALSE(turned_headings(drive(8, radians(15))));
  CHECK_FALSE(turned_headings(drive(5, radians(40))));
  CHECK_FALSE(turned_headings(drive(8, radians(40), 0.05)));
  CHECK_FALSE(turned_headings({}));
  std::vector<Fix> short_steps = drive(8, radians(40));
  for (Fix& fix : short_steps) *fix.position_in_grid *= 0.4;
  CHECK_FALSE(turned_headings(short_steps));
  std::vector<Fix> without = drive(8, radians(40));
  for (Fix& fix : without) fix.attitude.reset();
  CHECK_FALSE(turned_headings(without));
}

TEST_CASE("a vehicle at another height than the rig's is told by the median of its rows") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  rig.vehicle_height = 0.24;
  rig.height_sigma = 0.05;
  const auto told = [&](std::vector<double> heights) {
    std::vector<Fix> fixes;
    for (const double height : heights) {
      fixes.push_back(fix_at(1, static_cast<double>(fixes.size()), 0));
      fixes.back().survey = survey.name;
      fixes.back().position_in_grid->z() = height;
    }
    return wrong_height(fixes, {survey}, rig);
  };
  REQUIRE(told({0.09, 0.088, 0.24, 0.087}));
  CHECK(told({0.09, 0.088, 0.24, 0.087, 0.09})->sigmas == doctest::Approx(3.0));
  CHECK(told({0.37, 0.38, 0.39}));
  CHECK_FALSE(told({0.09, 0.088}));
  CHECK_FALSE(told({0.09, 0.24, 0.25}));
  CHECK_FALSE(told({0.13, 0.13, 0.13}));
}

TEST_CASE("a range that is longer than the tags say in most rows is told, echoes are not") {
  const Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  const std::string name = rig.ranges.front().name;
  const auto told = [&](const std::vector<double>& sigmas) {
    std::vector<Fix> fixes;
    for (const double difference : sigmas) {
      fixes.push_back(fix_at(1, static_cast<double>(fixes.size()), 0));
      fixes.back().checked_ranges = {{name, 0.01 * difference, difference}};
      fixes.back().unchecked = {{Unchecked::Kind::lens, "left", 0.03},
                                {Unchecked::Kind::moment, "", 0}};
    }
    return wrong_range(fixes, rig);
  };
  REQUIRE(told({2.4, 2.8, 3.1, 2.6, 2.9}));
  CHECK(told({2.4, 2.8, 3.1, 2.6, 2.9})->metres == doctest::Approx(0.028));
  CHECK(told({2.4, 2.8, 3.1, 2.6, 2.9})->tags_may_be_wrong);
  // The tags would show a mistake of more than 3 cm.
  REQUIRE(told({-7, -6, -6.5, -7.2, 0.3, -6.4}));
  CHECK_FALSE(told({-7, -6, -6.5, -7.2, 0.3, -6.4})->tags_may_be_wrong);
  CHECK_FALSE(told({2.8, 3.1, 2.6, 2.9}));
  CHECK_FALSE(told({0.2, -0.5, 140, 60, 0.8}));
  CHECK_FALSE(told({0.2, 2.8, 3, 0.5, 1}));
  CHECK_FALSE(told({7, -7, 6, -6, 7.5, -8}));
}

TEST_CASE("steps of a dense drive are put together") {
  std::vector<Fix> dense;
  for (int i = 0; i < 60; ++i) dense.push_back(fix_at(0, 0.1 * i, radians(40)));
  REQUIRE(turned_headings(dense));
  CHECK(degrees(turned_headings(dense)->angle) == doctest::Approx(40));
  dense.resize(20);
  CHECK_FALSE(turned_headings(dense));
}

TEST_CASE("positions of a vehicle that drives lose what confirms them once the last are in doubt") {
  const Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  rig.vehicle_height = 0.24;
  rig.height_sigma = 0.05;
  LiveDoubts doubts;
  const auto judged = [&](double height) {
    Fix fix = fix_at(1, 1, 0);
    fix.survey = survey.name;
    fix.position_in_grid->z() = height;
    fix.confirmations = 2;
    return doubts.judged(std::move(fix), {survey}, rig);
  };
  CHECK(judged(0.09).confirmations == 2);
  CHECK(judged(0.09).confirmations == 2);
  const Fix third = judged(0.09);
  CHECK(third.confirmations == 0);
  CHECK(third.position_in_grid);
  REQUIRE(third.notes.size() == 1);
  CHECK(
      third.notes.front().starts_with("do not rely on this position: the vehicle stands 0.090 m"));
  CHECK(if_confirmed(third).reason == third.doubt);
  for (int i = 0; i < 3; ++i) judged(0.24);
  CHECK(judged(0.24).confirmations == 2);
}

TEST_CASE("places that were chosen across the drive as well tell nothing") {
  std::vector<Fix> fixes;
  for (int i = 0; i < 12; ++i) fixes.push_back(fix_at(i % 2 == 0 ? 1.0 : 2.0, 0.6 * i, 0));
  CHECK_FALSE(turned_headings(fixes));
}

}  // namespace tagsmith::detail
