// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

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

namespace {

// A pose near the corridor's middle, drawn at random.
VehiclePose random_pose(std::mt19937_64& random) {
  std::uniform_real_distribution<double> either(-1, 1);
  VehiclePose pose;
  pose.position = {0.3 * either(random), 2.5 + 2 * either(random), 0.24};
  pose.heading = radians(8) * either(random);
  return pose;
}

// Noisy corners, attitude priors, range and plates that hang a little off, fitted by Gauss-Newton
// steps; the fit's error in x, y, z, heading, pitch, roll.
Eigen::Matrix<double, 6, 1> error_of_fit(const Survey& survey, const Rig& rig,
                                         const VehiclePose& truth,
                                         const std::vector<PlateSight>& sights, double corner_sigma,
                                         std::mt19937_64& random) {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  std::normal_distribution<double> unit(0, 1);
  const double tilt = rig.roll_sigma;
  const Eigen::Vector2d seen_tilt(tilt * unit(random), tilt * unit(random));  // pitch, roll
  const double seen_range =
      observe_wall(survey.tunnel.centerline, -0.95, truth.position).distance + 0.01 * unit(random);
  std::vector<std::array<Eigen::Vector2d, 4>> pixels;
  const std::array<Eigen::Vector3d, 4> corners{
      Eigen::Vector3d(0, 0, 0), {0.343, 0, 0}, {0.343, 0.168, 0}, {0, 0.168, 0}};
  const auto observe = [&](const PlateSight& sight, const VehiclePose& pose, std::size_t corner,
                           const Eigen::Vector3d& shift) {
    const RigCamera& camera = rig.cameras[sight.camera];
    Pose plate = survey.tags[sight.tag].world_from_plate;
    plate.translation += shift;
    return observe_point(camera.camera, camera.vehicle_from_camera, vehicle_frame(pose), plate,
                         corners[corner])
        .value();
  };
  for (const PlateSight& sight : sights) {
    const Eigen::Vector3d shift =
        survey.sigma * Eigen::Vector3d(unit(random), unit(random), unit(random));
    pixels.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      pixels.back()[i] = observe(sight, truth, i, shift).pixel +
                         corner_sigma * Eigen::Vector2d(unit(random), unit(random));
    }
  }
  VehiclePose pose = truth;
  pose.position += Eigen::Vector3d(0.02, -0.03, 0.02);
  for (int step = 0; step < 6; ++step) {
    VehicleCovariance information = rig_information(survey, rig, pose);
    Vector6 gradient = Vector6::Zero();
    gradient[vehicle_parameter::kPitch] = (seen_tilt[0] - pose.pitch) / (tilt * tilt);
    gradient[vehicle_parameter::kRoll] = (seen_tilt[1] - pose.roll) / (tilt * tilt);
    const ObservedWall wall = observe_wall(survey.tunnel.centerline, -0.95, pose.position);
    gradient.head<3>() += wall.by_position * (seen_range - wall.distance) / 1e-4;
    for (std::size_t s = 0; s < sights.size(); ++s) {
      VehicleCovariance own = VehicleCovariance::Zero();
      Vector6 pull = Vector6::Zero();
      for (std::size_t i = 0; i < 4; ++i) {
        const ObservedPoint point = observe(sights[s], pose, i, Eigen::Vector3d::Zero());
        const double weight = 1 / (corner_sigma * corner_sigma);
        own += weight * point.by_vehicle.transpose() * point.by_vehicle;
        pull += weight * point.by_vehicle.transpose() * (pixels[s][i] - point.pixel);
      }
      // The plate's own shift is eliminated, as in with_survey_error.
      const Eigen::Matrix3d on_shift =
          own.topLeftCorner<3, 3>() + Eigen::Matrix3d::Identity() / (survey.sigma * survey.sigma);
      const Vector6 left = pull - own.leftCols<3>() * on_shift.llt().solve(pull.head<3>());
      gradient += left;
      information += with_survey_error(own, survey.sigma);
    }
    const Vector6 change = information.ldlt().solve(gradient);
    pose.position += change.head<3>();
    pose.heading += change[vehicle_parameter::kHeading];
    pose.pitch += change[vehicle_parameter::kPitch];
    pose.roll += change[vehicle_parameter::kRoll];
  }
  Vector6 error;
  error << pose.position - truth.position, pose.heading - truth.heading, pose.pitch, pose.roll;
  return error;
}

}  // namespace

TEST_CASE("over 1,000 poses predicted sigmas are within 15 % of those of least-squares fits") {
  const Survey survey = straight_survey(10, 8);
  const Rig rig = crawler();
  AccuracyOptions options;
  options.corner_sigma_px = 0.3;
  std::mt19937_64 random(3);
  Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();
  int fits = 0;
  for (int draw = 0; draw < 1000; ++draw) {
    const VehiclePose pose = random_pose(random);
    const auto sights = sights_from(survey, rig, pose);
    if (sights.empty()) continue;
    const VehicleCovariance covariance = expected(survey, rig, pose, options);
    const auto error = error_of_fit(survey, rig, pose, sights, 0.3, random);
    squares += error.cwiseAbs2().cwiseQuotient(covariance.diagonal());
    ++fits;
  }
  CHECK(fits > 900);
  std::string ratios;
  for (int i = 0; i < 6; ++i) {
    const double observed_to_predicted = std::sqrt(squares[i] / fits);
    ratios += std::to_string(observed_to_predicted) + " ";
    CHECK(observed_to_predicted > 0.85);
    CHECK(observed_to_predicted < 1.15);
  }
  MESSAGE("observed / predicted sigma of x, y, z, heading, pitch, roll: " << ratios);
}
