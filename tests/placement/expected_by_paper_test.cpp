// SPDX-License-Identifier: Apache-2.0
// What a plan says of the published method is what the method does (decoder/paper).
#include "tagsmith/paper_plan/expected_by_paper.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/paper/closed_form.hpp"
#include "tests/placement/corridors.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

constexpr double kWidth = 1.9;
constexpr double kStagger = 0.343;

Survey exact_survey() {
  Survey survey = straight_survey(10, 8);
  survey.sigma = 0;
  for (PlacedTag& tag : survey.tags) tag.sigma = 0;
  return survey;
}

std::size_t index_of(const Survey& survey, const std::string& name) {
  return static_cast<std::size_t>(find_tag(survey, name) - survey.tags.data());
}

// The left camera's sights of tags on the left wall, the right one's of those on the right.
std::vector<PlateSight> sights_of(const Survey& survey, const std::vector<std::string>& names) {
  std::vector<PlateSight> sights;
  for (const std::string& name : names) {
    PlateSight sight;
    sight.camera = name.back() == 'L' ? 0 : 1;
    sight.tag = index_of(survey, name);
    sights.push_back(sight);
  }
  return sights;
}

AccuracyOptions with_corner_sigma(double sigma_px) {
  AccuracyOptions options;
  options.corner_sigma_px = sigma_px;
  return options;
}

VehiclePose pose_at(double across, double along, double height) {
  VehiclePose pose;
  pose.position = {across, along, height};
  return pose;
}

// What the method is given at the pose when nothing is off.
ClosedFormInput exact_input(const Survey& survey, const VehiclePose& pose) {
  ClosedFormInput input;
  input.p1_in_world = find_tag(survey, "003L")->world_from_plate.translation;
  input.p2_in_world = find_tag(survey, "003R")->world_from_plate.translation;
  input.pair_angle = std::atan(kStagger / kWidth);
  input.tunnel_width = kWidth;
  input.wall_distance = kWidth / 2 + pose.position.x();
  input.distance1 = (pose.position - input.p1_in_world).norm();
  input.distance2 = (pose.position - input.p2_in_world).norm();
  input.tags_are_above = input.p1_in_world.z() > pose.position.z();
  return input;
}

// Of the method's position by one of its measurements.
Eigen::Vector3d derivative(ClosedFormInput input, double ClosedFormInput::*measurement) {
  constexpr double kStep = 1e-6;
  input.*measurement += kStep;
  const Eigen::Vector3d longer = paper_position(input).value();
  input.*measurement -= 2 * kStep;
  return (longer - paper_position(input).value()) / (2 * kStep);
}

// D by (10) is as uncertain as the edge's length in pixels, which is short by its depth.
double distance_sigma(const Rig& rig, std::size_t camera, const Eigen::Vector3d& corner,
                      const VehiclePose& pose, double edge, double corner_sigma_px) {
  const Pose world_from_camera = world_from_vehicle(pose) * rig.cameras[camera].vehicle_from_camera;
  const double depth = (inverse(world_from_camera) * corner).z();
  const double edge_px = rig.cameras[camera].camera.fy * edge / depth;
  return (pose.position - corner).norm() * std::sqrt(2.0) * corner_sigma_px / edge_px;
}

const VehiclePose kPoses[] = {pose_at(0.05, 0.3, 0.24), pose_at(-0.2, 0.2, 0.2),
                              pose_at(0.1, 0.4, 0.75)};

}  // namespace

TEST_CASE("small errors of the measurements leave what the method's derivatives make of them") {
  const Survey survey = exact_survey();
  const double edge = survey.tag_template.frame_inner_height;
  for (const VehiclePose& pose : kPoses) {
    CAPTURE(pose.position.transpose());
    const ClosedFormInput input = exact_input(survey, pose);
    REQUIRE(paper_position(input).has_value());
    for (const double share_of_corners : {0.0, 1.0, 100.0}) {
      CAPTURE(share_of_corners);
      Rig rig = crawler();
      rig.ranges.front().sigma = 1e-6;
      const double corner_sigma_px = 2e-5 * share_of_corners;
      const double sigma1 = distance_sigma(rig, 0, input.p1_in_world, pose, edge, corner_sigma_px);
      const double sigma2 = distance_sigma(rig, 1, input.p2_in_world, pose, edge, corner_sigma_px);
      const Eigen::Vector3d by1 = derivative(input, &ClosedFormInput::distance1) * sigma1;
      const Eigen::Vector3d by2 = derivative(input, &ClosedFormInput::distance2) * sigma2;
      const Eigen::Vector3d byd = derivative(input, &ClosedFormInput::wall_distance) * 1e-6;
      const Eigen::Matrix3d expected =
          by1 * by1.transpose() + by2 * by2.transpose() + byd * byd.transpose();
      const auto paper = expect_by_paper(survey, rig, pose, sights_of(survey, {"003L", "003R"}),
                                         with_corner_sigma(corner_sigma_px));
      REQUIRE(paper.has_value());
      CHECK(paper->no_solution_share == 0);
      CHECK((paper->mean_square - expected).norm() < 0.005 * expected.norm());
    }
  }
}

TEST_CASE("a plate that is off is as far off in D as the survey is in it") {
  Survey survey = exact_survey();
  const VehiclePose& pose = kPoses[0];
  Rig rig = crawler();
  rig.ranges.front().sigma = 1e-9;
  survey.tags[index_of(survey, "003L")].sigma = 1e-6;
  const auto paper = expect_by_paper(survey, rig, pose, sights_of(survey, {"003L", "003R"}),
                                     with_corner_sigma(1e-9));
  REQUIRE(paper.has_value());
  const Eigen::Vector3d by1 =
      derivative(exact_input(survey, pose), &ClosedFormInput::distance1) * 1e-6;
  CHECK((paper->mean_square - by1 * by1.transpose()).norm() < 0.005 * by1.squaredNorm());
}

TEST_CASE("without two tags of one pair the method takes the two that hang nearest abreast") {
  const Survey survey = exact_survey();
  const Rig rig = crawler();
  const VehiclePose pose = pose_at(0, -0.5, 0.24);
  const auto magnification = [&](const std::vector<std::string>& names) {
    const auto paper =
        expect_by_paper(survey, rig, pose, sights_of(survey, names), with_corner_sigma(0.1));
    return paper ? paper->magnification : 0;
  };
  const double pairs_apart = find_tag(survey, "001L")->world_from_plate.translation.y() -
                             find_tag(survey, "000L")->world_from_plate.translation.y();
  const double ahead = kStagger + pairs_apart, behind = 3 * pairs_apart - kStagger;
  CHECK(magnification({"003L", "004R"}) == doctest::Approx(kWidth / ahead));
  CHECK(magnification({"003L", "000R"}) == doctest::Approx(kWidth / behind));
  CHECK(magnification({"003L", "004R", "000R"}) == doctest::Approx(kWidth / ahead));
  CHECK(magnification({"003L", "000R", "004R"}) == doctest::Approx(kWidth / ahead));
  CHECK(magnification({"003L", "000R", "004R", "003R"}) == doctest::Approx(kWidth / kStagger));
  CHECK(magnification({"003L", "004L"}) == 0);
}

TEST_CASE("the finest range to the left wall counts that reaches it") {
  const Survey survey = exact_survey();
  const VehiclePose& pose = kPoses[0];
  const auto with_ranges = [&](const std::vector<RigRange>& ranges) {
    Rig rig = crawler();
    rig.ranges = ranges;
    return expect_by_paper(survey, rig, pose, sights_of(survey, {"003L", "003R"}),
                           with_corner_sigma(1e-6));
  };
  const RigRange fine{"fine", Side::left, 0.25, 5, 1e-5},
      coarse{"coarse", Side::left, 0.25, 5, 1e-4}, far{"far", Side::left, 3, 9, 1e-6},
      near{"near", Side::left, 0.1, 0.5, 1e-6}, right{"right", Side::right, 0.25, 5, 1e-6};
  const auto alone = with_ranges({fine});
  REQUIRE(alone.has_value());
  for (const auto& ranges : {std::vector{coarse, fine}, std::vector{fine, coarse},
                             std::vector{far, fine}, std::vector{fine, near, right}}) {
    const auto paper = with_ranges(ranges);
    REQUIRE(paper.has_value());
    CHECK(paper->mean_square == alone->mean_square);
  }
  for (const auto& ranges : {std::vector{far}, std::vector{near}, std::vector{right}}) {
    CHECK_FALSE(with_ranges(ranges).has_value());
  }
}
