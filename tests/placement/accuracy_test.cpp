// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <doctest/doctest.h>

#include "decoder/paper/closed_form.hpp"
#include "tagsmith/placement/expected_accuracy.hpp"
#include "tests/placement/corridors.hpp"

using namespace tagsmith;
using namespace tagsmith::test;

namespace {

std::vector<PlateSight> sights_from(const Survey& survey, const Rig& rig, const VehiclePose& pose) {
  const SightModel model(survey, rig);
  std::vector<PlateSight> sights;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const CameraStand stand = model.stand(camera, world_from_vehicle(pose), 0);
    for (std::size_t tag = 0; tag < survey.tags.size(); ++tag) {
      if (const auto sight = model.look(camera, stand, tag, nullptr)) sights.push_back(*sight);
    }
  }
  return sights;
}

VehicleCovariance expected(const Survey& survey, const Rig& rig, const VehiclePose& pose,
                           const AccuracyOptions& options) {
  VehicleCovariance information = rig_information(survey, rig, pose);
  for (const PlateSight& sight : sights_from(survey, rig, pose)) {
    information += with_survey_error(
        corner_information(survey, rig, vehicle_frame(pose), sight, options), survey.sigma);
  }
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
  const auto alone =
      covariance_from(rig_information(survey, rig, pose) +
                      corner_information(survey, rig, vehicle_frame(pose), sights[0], {}));
  Survey exact = survey;
  exact.sigma = 0;
  const VehicleCovariance both = expected(exact, rig, pose, {});
  REQUIRE(alone.has_value());
  for (int i = 0; i < 6; ++i) CHECK(both(i, i) <= (*alone)(i, i) * (1 + 1e-9));
}

TEST_CASE("nothing seen is no position") {
  const Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  VehiclePose pose;
  pose.position = {0, 9, 0.24};
  CHECK_FALSE(covariance_from(rig_information(survey, rig, pose)).has_value());
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
  const int draws = 4000;
  for (int i = 0; i < draws; ++i) {
    input.wall_distance = d + noise(random);
    if (!paper_position(input)) ++failed;
  }
  CHECK(paper->no_solution_share ==
        doctest::Approx(static_cast<double>(failed) / draws).epsilon(0.1));
  // The slope in d, by a step to the side that has solutions.
  input.wall_distance = d - 1e-5;
  const auto stepped = paper_position(input);
  REQUIRE(stepped.has_value());
  const double along = (*stepped - pose.position).y() / 1e-5 * 0.01;
  CHECK(std::sqrt(paper->covariance(1, 1)) == doctest::Approx(std::abs(along)).epsilon(0.03));
}

TEST_CASE("predicted sigmas are those of least-squares fits to noisy corners") {
  Survey survey = straight_survey(10, 8);
  survey.sigma = 0;
  const Rig rig = crawler();
  VehiclePose pose;
  pose.position = {0.1, 2.3, 0.24};
  pose.heading = radians(3);
  AccuracyOptions options;
  options.corner_sigma_px = 0.3;
  const auto sights = sights_from(survey, rig, pose);
  const VehicleCovariance covariance = expected(survey, rig, pose, options);
  std::mt19937_64 random(3);
  std::normal_distribution<double> unit(0, 1);
  Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();
  const int draws = 500;
  for (int draw = 0; draw < draws; ++draw) {
    // One Gauss-Newton step from the truth: the noise is small.
    VehicleCovariance information = rig_information(survey, rig, pose);
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    const Eigen::LLT<VehicleCovariance> prior(information + 1e-12 * VehicleCovariance::Identity());
    Eigen::Matrix<double, 6, 1> normal;
    for (int i = 0; i < 6; ++i) normal[i] = unit(random);
    gradient += prior.matrixL() * normal;
    for (const PlateSight& sight : sights) {
      for (const double x : {0.0, 0.343}) {
        for (const double y : {0.0, 0.168}) {
          const RigCamera& camera = rig.cameras[sight.camera];
          const auto point =
              observe_point(camera.camera, camera.vehicle_from_camera, vehicle_frame(pose),
                            survey.tags[sight.tag].world_from_plate, {x, y, 0});
          const Eigen::Vector2d error(0.3 * unit(random), 0.3 * unit(random));
          information += point->by_vehicle.transpose() * point->by_vehicle / 0.09;
          gradient += point->by_vehicle.transpose() * error / 0.09;
        }
      }
    }
    const Eigen::Matrix<double, 6, 1> step = information.ldlt().solve(gradient);
    squares += step.cwiseAbs2();
  }
  for (int i = 0; i < 6; ++i) {
    CAPTURE(i);
    CHECK(std::sqrt(squares[i] / draws) ==
          doctest::Approx(std::sqrt(covariance(i, i))).epsilon(0.1));
  }
}
