// SPDX-License-Identifier: Apache-2.0
#include "tests/support/plan_trial.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Cholesky>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"

namespace tagsmith::detail::test {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

VehiclePose draw_pose(const SightModel& model, const CenterlinePoint& floor, bool tilts,
                      Draws& draws) {
  const Rig& rig = model.rig();
  const VehicleEnvelope envelope = rig.envelope.value_or(
      VehicleEnvelope{0.1 * least_width(model.survey().tunnel), radians(5), 0, 0, 0});
  FloorStance stance;
  stance.height = rig.vehicle_height;
  stance.lateral = draws.uniform(-1, 1) * envelope.lateral;
  stance.yaw = draws.uniform(-1, 1) * envelope.yaw;
  if (tilts) {
    stance.height += draws.normal(rig.height_sigma);
    stance.pitch = draws.normal(rig.pitch_sigma);
    stance.roll = draws.normal(rig.roll_sigma);
  }
  return vehicle_on_floor(floor, stance);
}

std::vector<PlateSight> read_sights(const SightModel& model, const VehiclePose& pose,
                                    double speed) {
  const Survey& survey = model.survey();
  const double chainage = survey.tunnel.centerline.locate(pose.position.head<2>()).chainage;
  const double reach = model.reach();
  const Surroundings around = model.surroundings(chainage, chainage);
  std::vector<PlateSight> sights;
  for (std::size_t camera = 0; camera < model.rig().cameras.size(); ++camera) {
    const double moved = speed * model.rig().cameras[camera].exposure.value_or(0);
    const CameraStand stand = model.stand(camera, world_from_vehicle(pose), 0);
    for (const std::size_t tag : model.tags_between(chainage - reach, chainage + reach)) {
      const auto sight = model.look(camera, stand, tag, around);
      if (sight && sight->travel_book >= moved) sights.push_back(*sight);
    }
  }
  return sights;
}

// Where the camera sees the plate's corners, with noise.
SeenCorners seen_corners(const Survey& survey, const RigCamera& camera, const VehiclePose& truth,
                         const Pose& world_from_plate, double sigma, Draws& draws) {
  const double length = survey.tag_template.frame_inner_length;
  const double height = survey.tag_template.frame_inner_height;
  const Eigen::Vector3d corners[] = {
      {0, 0, 0}, {length, 0, 0}, {length, height, 0}, {0, height, 0}};
  SeenCorners seen;
  seen.sigma_px = sigma;
  seen.covariance *= sigma * sigma;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto point = observe_point(camera.camera, camera.vehicle_from_camera,
                                     vehicle_frame(truth), world_from_plate, corners[i]);
    const Eigen::Vector2d pixel = point ? point->pixel : Eigen::Vector2d::Zero().eval();
    seen.corners[i] = {pixel.x() + draws.normal(sigma), pixel.y() + draws.normal(sigma)};
  }
  return seen;
}

void measure_tags(const SightModel& model, const AccuracyOptions& options, Draws& draws,
                  PlanTrial& trial) {
  const Survey& survey = model.survey();
  const Rig real = disturbed(model.rig(), draws);
  std::vector<std::pair<std::size_t, Pose>> hung;
  for (const PlateSight& sight : trial.sights) {
    auto known = std::ranges::find(hung, sight.tag, [](const auto& entry) { return entry.first; });
    if (known == hung.end()) {
      Pose pose = survey.tags[sight.tag].world_from_plate;
      pose.translation += draws.normals(survey.sigma);
      pose.rotation *= small_turn(draws, survey.angle_sigma);
      known = hung.insert(hung.end(), {sight.tag, pose});
    }
    const RigCamera& camera = real.cameras[sight.camera];
    trial.observation.tags.push_back(
        {camera.name,
         0,
         survey.tags[sight.tag],
         seen_corners(survey, camera, trial.truth, known->second,
                      expected_corner_sigma(model.rig(), sight, options), draws),
         {}});
  }
}

void measure_ranges(const SightModel& model, Draws& draws, PlanTrial& trial) {
  const Tunnel& tunnel = model.survey().tunnel;
  for (const RigRange& range : model.rig().ranges) {
    const double distance =
        observe_wall(tunnel.centerline, wall_of(tunnel, range.wall), trial.truth.position).distance;
    if (distance < range.min || distance > range.max) continue;
    trial.observation.ranges[range.name] = distance + draws.normal(range.sigma);
  }
}

}  // namespace

PlanTrial draw_trial(const SightModel& model, const TrialPoses& poses,
                     const AccuracyOptions& options, Draws& draws) {
  PlanTrial trial;
  trial.floor = model.survey().tunnel.centerline.at(draws.uniform(poses.from, poses.to));
  trial.truth = draw_pose(model, trial.floor, poses.tilts, draws);
  trial.sights = read_sights(model, trial.truth, options.speed);
  measure_tags(model, options, draws, trial);
  measure_ranges(model, draws, trial);
  return trial;
}

std::optional<VehicleCovariance> expected_covariance(const SightModel& model,
                                                     const PlanTrial& trial,
                                                     const AccuracyOptions& options) {
  const Survey& survey = model.survey();
  const Rig& rig = model.rig();
  return covariance_from(
      rig_information(survey, rig, trial.floor, trial.truth) +
      sights_information(survey, rig, vehicle_frame(trial.truth), trial.sights, options));
}

Vector6 error_in_world(const Fix& fix, const VehiclePose& truth, const Grid& grid) {
  Vector6 error;
  error.head<3>() = world_from_grid(grid, *fix.position_in_grid) - truth.position;
  error.tail<3>().setZero();
  if (!fix.attitude) return error;
  const double heading = world_heading_from_grid(grid, fix.attitude->heading);
  error.tail<3>() << std::remainder(heading - truth.heading, 2 * std::numbers::pi),
      fix.attitude->pitch - truth.pitch, fix.attitude->roll - truth.roll;
  return error;
}

void count(TrialTally& tally, const Vector6& error, const VehicleCovariance& expected,
           double drive_heading) {
  VehicleCovariance turn = VehicleCovariance::Identity();
  turn.block<1, 3>(0, 0) = direction_of(drive_heading).transpose();
  turn.block<1, 3>(1, 0) = right_of(drive_heading).transpose();
  const Vector6 turned = turn * error;
  const VehicleCovariance covariance = turn * expected * turn.transpose();
  tally.squares += turned.cwiseAbs2().cwiseQuotient(covariance.diagonal());
  const Eigen::Vector3d position = error.head<3>();
  tally.nees_position += position.dot(expected.topLeftCorner<3, 3>().ldlt().solve(position)) / 3;
  tally.nees_pose += error.dot(expected.ldlt().solve(error)) / 6;
  const Eigen::Vector2d plane = error.head<2>();
  constexpr double kChiSquare95 = 5.991;  // two degrees of freedom
  if (plane.dot(expected.topLeftCorner<2, 2>().ldlt().solve(plane)) < kChiSquare95) {
    ++tally.in_ellipse;
  }
  ++tally.located;
}

}  // namespace tagsmith::detail::test
