// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/pose.hpp"

#include <numbers>
#include <random>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"

using namespace tagsmith::detail;

namespace {

Pose random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  std::uniform_real_distribution<double> length(-10, 10);
  Pose pose;
  pose.rotation = rotation_from_yaw_pitch_roll(angle(random), angle(random), angle(random));
  pose.translation = {length(random), length(random), length(random)};
  return pose;
}

double distance_from_identity(const Pose& pose) {
  return (pose.rotation - Eigen::Matrix3d::Identity()).norm() + pose.translation.norm();
}

}  // namespace

TEST_CASE("a pose times its inverse is the identity") {
  constexpr unsigned kSeed = 11;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 200; ++i) {
    const Pose a_from_b = random_pose(random);
    CHECK(distance_from_identity(a_from_b * inverse(a_from_b)) < 1e-12);
    CHECK(distance_from_identity(inverse(a_from_b) * a_from_b) < 1e-12);
  }
}

TEST_CASE("poses compose as the points they move") {
  constexpr unsigned kSeed = 12;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 200; ++i) {
    const Pose a_from_b = random_pose(random);
    const Pose b_from_c = random_pose(random);
    const Eigen::Vector3d point = random_pose(random).translation;
    CHECK(((a_from_b * b_from_c) * point - a_from_b * (b_from_c * point)).norm() < 1e-12);
  }
}

TEST_CASE("yaw turns left, pitch noses down, roll leans right") {
  const Eigen::Vector3d forward = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const double quarter = radians(90);
  CHECK((rotation_from_yaw_pitch_roll(quarter, 0, 0) * forward - left).norm() < 1e-15);
  CHECK((rotation_from_yaw_pitch_roll(0, quarter, 0) * forward + up).norm() < 1e-15);
  CHECK((rotation_from_yaw_pitch_roll(0, 0, quarter) * left - up).norm() < 1e-15);
}

TEST_CASE("the rotation is yaw of pitch of roll, and proper") {
  const Eigen::Matrix3d rotation = rotation_from_yaw_pitch_roll(0.3, -0.2, 0.1);
  const Eigen::Matrix3d product = rotation_from_yaw_pitch_roll(0.3, 0, 0) *
                                  rotation_from_yaw_pitch_roll(0, -0.2, 0) *
                                  rotation_from_yaw_pitch_roll(0, 0, 0.1);
  CHECK((rotation - product).norm() < 1e-15);
  CHECK(rotation.determinant() == doctest::Approx(1.0));
}
