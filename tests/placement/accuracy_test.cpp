// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/localize/joint_method.hpp"
#include "decoder/paper/closed_form.hpp"
#include "tagsmith/paper_plan/expected_by_paper.hpp"
#include "tests/placement/corridors.hpp"
#include "tests/support/plan_trial.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

CenterlinePoint floor_below(const Survey& survey, const VehiclePose& pose) {
  const Centerline& line = survey.tunnel.centerline;
  return line.at(line.locate(pose.position.head<2>()).chainage);
}

std::vector<PlateSight> sights_from(const Survey& survey, const Rig& rig, const VehiclePose& pose) {
  const SightModel model(survey, rig);
  std::vector<PlateSight> sights;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const CameraStand stand = model.stand(camera, world_from_vehicle(pose), 0);
    for (std::size_t tag = 0; tag < survey.tags.size(); ++tag) {
      if (const auto sight = model.look(camera, stand, tag, {})) sights.push_back(*sight);
    }
  }
  return sights;
}

VehicleCovariance expected(const Survey& survey, const Rig& rig, const VehiclePose& pose,
                           const AccuracyOptions& options) {
  VehicleCovariance information = rig_information(survey, rig, floor_below(survey, pose), pose);
  information +=
      sights_information(survey, rig, vehicle_frame(pose), sights_from(survey, rig, pose), options);
  const auto covariance = covariance_from(information);
  REQUIRE(covariance.has_value());
  return *covariance;
}

}  // namespace

TEST_CASE("the survey's error in two tags leaves half its variance in the position") {
  Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  VehiclePose pose;
  pose.position = {0, 2, 0.24};
  AccuracyOptions options;
  options.corner_sigma_px = 1e-4;
  survey.sigma = 0.01;
  for (PlacedTag& tag : survey.tags) tag.sigma = survey.sigma;
  const std::size_t tags = sights_from(survey, rig, pose).size();
  REQUIRE(tags == 2);
  const VehicleCovariance covariance = expected(survey, rig, pose, options);
  CHECK(std::sqrt(covariance(2, 2)) == doctest::Approx(0.01 / std::sqrt(2.0)).epsilon(0.05));
}

TEST_CASE("a tag less never makes a position better") {
  const Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  VehiclePose pose;
  pose.position = {0.1, 2, 0.24};
  const auto sights = sights_from(survey, rig, pose);
  REQUIRE(sights.size() >= 2);
  Survey exact = survey;
  exact.sigma = 0;
  for (PlacedTag& tag : exact.tags) tag.sigma = 0;
  const auto alone =
      covariance_from(rig_information(survey, rig, floor_below(survey, pose), pose) +
                      sights_information(exact, rig, vehicle_frame(pose), {&sights[0], 1}, {}));
  const VehicleCovariance both = expected(exact, rig, pose, {});
  REQUIRE(alone.has_value());
  for (int i = 0; i < 6; ++i) CHECK(both(i, i) <= (*alone)(i, i) * (1 + 1e-9));
}

TEST_CASE("nothing seen is no position") {
  const Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  VehiclePose pose;
  pose.position = {0, 9, 0.24};
  CHECK_FALSE(
      covariance_from(rig_information(survey, rig, floor_below(survey, pose), pose)).has_value());
  CHECK_FALSE(expect_by_paper(survey, rig, pose, {}, {}).has_value());
}

TEST_CASE("the paper's method: its magnification, its sigma and its failures are those of draws") {
  const Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  VehiclePose pose;
  pose.position = {0.05, 2, 0.24};
  AccuracyOptions options;
  options.corner_sigma_px = 0.01;
  Survey exact = survey;
  exact.sigma = 0;
  const auto paper = expect_by_paper(exact, rig, pose, sights_from(exact, rig, pose), options);
  REQUIRE(paper.has_value());
  CHECK(paper->magnification == doctest::Approx(1.9 / 0.343).epsilon(1e-6));

  const PlacedTag* left = find_tag(survey, "003L");
  const PlacedTag* right = find_tag(survey, "003R");
  ClosedFormInput input;
  input.p1_in_world = left->world_from_plate.translation;
  input.p2_in_world = right->world_from_plate.translation;
  input.pair_angle = std::atan(0.343 / 1.9);
  input.tunnel_width = 1.9;
  input.distance1 = (pose.position - input.p1_in_world).norm();
  input.distance2 = (pose.position - input.p2_in_world).norm();
  const double d = 0.95 + pose.position.x();
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, 0.01);
  int failed = 0;
  double along_sq = 0;
  const int draws = 4000;
  for (int i = 0; i < draws; ++i) {
    input.wall_distance = d + noise(random);
    const auto position = paper_position(input);
    if (position && position->z() >= 0) {
      along_sq += std::pow(position->y() - pose.position.y(), 2);
    } else {
      ++failed;
    }
  }
  CHECK(paper->no_solution_share ==
        doctest::Approx(static_cast<double>(failed) / draws).epsilon(0.15));
  const double observed = std::sqrt(along_sq / (draws - failed));
  CHECK(std::sqrt(paper->mean_square(1, 1)) == doctest::Approx(observed).epsilon(0.1));
}

namespace {

// Observed over expected standard deviations of the joint method over so many poses.
TrialTally joint_trials(const Survey& survey, const Rig& rig, int count_wanted) {
  const SightModel model(survey, rig);
  AccuracyOptions options;
  options.corner_sigma_px = 0.1;
  Draws draws(3);
  TrialTally tally;
  while (tally.expected < count_wanted) {
    const PlanTrial trial = draw_trial(model, {0.5, 4.5, true}, options, draws);
    if (trial.sights.empty()) continue;
    const auto covariance = expected_covariance(model, trial, options);
    if (!covariance) continue;
    ++tally.expected;
    const Fix fix = localize_jointly(trial.observation, {survey}, rig);
    if (!fix.position_in_grid) continue;
    count(tally, error_in_world(fix, trial.truth, survey.grid), *covariance, trial.floor.heading);
  }
  return tally;
}

void check_ratios(const TrialTally& tally) {
  CHECK(tally.located > 0.97 * tally.expected);
  const auto ratios = tally.ratios();
  for (Eigen::Index i = 0; i < 6; ++i) {
    CAPTURE(i);
    CHECK(ratios[i] > 0.85);
    CHECK(ratios[i] < 1.15);
  }
  CHECK(tally.nees_pose / tally.located > 0.85);
  CHECK(tally.nees_pose / tally.located < 1.15);
}

Rig crawler_of_uncertain_height() {
  Rig rig = crawler();
  rig.height_sigma = 0.05;
  return rig;
}

}  // namespace

TEST_CASE("over 1,000 poses the joint method scatters as planned, to 15 %") {
  check_ratios(joint_trials(straight_survey(10, 8), crawler_of_uncertain_height(), 1000));
}

TEST_CASE("calibrations, plates' angles, bends and grades are in the plan's covariance") {
  Rig rig = crawler_of_uncertain_height();
  for (RigCamera& camera : rig.cameras) {
    camera.calibration_sigma = {0.002, radians(0.1), 0.001, 1.0};
  }
  Survey survey = survey_along({{1, 0, 0.05}, {3, 0.1, -0.1}, {4, -0.1, 0.05}}, 8);
  survey.angle_sigma = radians(0.3);
  check_ratios(joint_trials(survey, rig, 600));
}

TEST_CASE("a plate that two cameras see is off for both of them") {
  Rig rig = crawler_of_uncertain_height();
  RigCamera second = rig.cameras[0];
  second.name = "second";
  second.vehicle_from_camera.translation = {0.1, 0.05, 0.1};
  rig.cameras.push_back(second);
  Survey survey = straight_survey(10, 8);
  survey.sigma = 0.01;
  for (PlacedTag& tag : survey.tags) tag.sigma = survey.sigma;
  const SightModel model(survey, rig);
  Draws draws(5);
  int twice = 0;
  for (int i = 0; i < 20; ++i) {
    const PlanTrial trial = draw_trial(model, {0.5, 4.5, true}, {}, draws);
    for (const PlateSight& sight : trial.sights) {
      twice += std::ranges::count(trial.sights, sight.tag, &PlateSight::tag) > 1 ? 1 : 0;
    }
  }
  REQUIRE(twice > 0);
  check_ratios(joint_trials(survey, rig, 400));
}
