// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include <Eigen/LU>
#include <tagsmith/rig.hpp>

#include "decoder/api/data.hpp"
#include "tagsmith/survey/assumptions.hpp"

namespace tagsmith {
namespace {

using detail::check_number;
using detail::throw_invalid;

constexpr double kLargestVehicle = 100;  // metres

detail::Side side_from(Side side) {
  return side == Side::left ? detail::Side::left : detail::Side::right;
}

// Nothing for a mirror or a matrix that stretches.
bool is_rotation(const Eigen::Matrix3d& matrix) {
  constexpr double kRounding = 1e-6;
  return (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).norm() < kRounding &&
         matrix.determinant() > 0;
}

detail::Pose pose_from(const Mounting& mounting, const std::string& camera) {
  detail::Pose pose{detail::eigen_from<3>(mounting.rotation),
                    detail::eigen_from(mounting.translation)};
  if (!is_rotation(pose.rotation)) {
    throw_invalid("the mounting of camera " + camera + " is no rotation");
  }
  for (const double coordinate : mounting.translation) {
    check_number("the place of camera " + camera, coordinate, -kLargestVehicle, kLargestVehicle);
  }
  return pose;
}

detail::CalibrationSigma sigma_from(const CalibrationSigma& sigma) {
  for (const double part : {sigma.position, sigma.angle, sigma.focal, sigma.center, sigma.edge}) {
    check_number("a camera's sigma", part, 0, 1000);
  }
  return {sigma.position, sigma.angle, sigma.focal, sigma.center, sigma.edge};
}

detail::RigCamera camera_from(const RigCamera& given) {
  detail::RigCamera camera;
  camera.name = given.name;
  camera.camera = detail::camera_from(given.model);
  camera.vehicle_from_camera = pose_from(given.vehicle_from_camera, given.name);
  if (given.side) camera.side = side_from(*given.side);
  if (given.exposure) check_number("a camera's exposure", *given.exposure, 1e-9, 10);
  camera.exposure = given.exposure;
  camera.calibration_sigma =
      given.sigma ? sigma_from(*given.sigma)
                  : detail::usual_calibration(detail::IntrinsicsSource::numbers, camera.camera);
  if (!given.sigma) camera.assumed_sigma = "all of it";
  return camera;
}

detail::RigRange range_from(const RigRange& range) {
  check_number("the least distance of range " + range.name, range.min, 0, 1000);
  check_number("the greatest distance of range " + range.name, range.max, range.min, 1000);
  check_number("sigma of range " + range.name, range.sigma, 1e-9, 100);
  return {range.name, side_from(range.wall), range.min, range.max, range.sigma};
}

detail::VehicleEnvelope envelope_from(const Envelope& envelope) {
  check_number("the envelope's lateral", envelope.lateral, 0, kLargestVehicle);
  check_number("the envelope's yaw", envelope.yaw, 0, 1.6);
  check_number("the envelope's speed", envelope.speed, 0, 100);
  check_number("the envelope's roll", envelope.roll, 0, 0.8);
  check_number("the envelope's pitch", envelope.pitch, 0, 0.8);
  return {envelope.lateral, envelope.yaw, envelope.speed, envelope.roll, envelope.pitch};
}

void check_names(const RigDescription& description) {
  std::set<std::string> names;
  const auto take = [&](const std::string& name) {
    if (name.empty()) throw_invalid("a camera or range of the rig has no name");
    if (!names.insert(name).second) throw_invalid("two parts of the rig are named " + name);
  };
  for (const RigCamera& camera : description.cameras) take(camera.name);
  for (const RigRange& range : description.ranges) take(range.name);
}

void add_readout(const Readout& readout, detail::Rig& rig) {
  const auto camera = std::ranges::find(rig.cameras, readout.camera, &detail::RigCamera::name);
  if (camera == rig.cameras.end()) {
    throw_invalid("a readout is of camera " + readout.camera + ", which the rig does not have");
  }
  check_number("the readout of camera " + readout.camera, readout.seconds, 0, 10);
  camera->readout = readout.seconds;
}

detail::Rig rig_from(const RigDescription& description, const std::vector<Readout>& readouts) {
  if (description.cameras.empty()) throw_invalid("the rig has no camera");
  check_names(description);
  check_number("the vehicle's height", description.vehicle_height, -kLargestVehicle,
               kLargestVehicle);
  check_number("height_sigma", description.height_sigma, 1e-9, 10);
  check_number("roll_sigma", description.roll_sigma, 1e-9, 1);
  check_number("pitch_sigma", description.pitch_sigma, 1e-9, 1);
  detail::Rig rig;
  rig.name = description.name;
  rig.file = description.name;  // its name in messages
  for (const RigCamera& camera : description.cameras) rig.cameras.push_back(camera_from(camera));
  for (const Readout& readout : readouts) add_readout(readout, rig);
  for (const RigRange& range : description.ranges) rig.ranges.push_back(range_from(range));
  rig.vehicle_height = description.vehicle_height;
  rig.height_sigma = description.height_sigma;
  rig.roll_sigma = description.roll_sigma;
  rig.pitch_sigma = description.pitch_sigma;
  if (description.envelope) rig.envelope = envelope_from(*description.envelope);
  detail::set_motion_sigmas(rig);
  return rig;
}

}  // namespace

Mounting mounting(const Vector3& position, double yaw, double pitch, double roll) {
  const detail::Pose pose =
      detail::vehicle_from_camera(yaw, pitch, roll, detail::eigen_from(position));
  return {detail::matrix_from<3>(pose.rotation), detail::vector_from(pose.translation)};
}

Rig::Rig(const RigDescription& description) : Rig(description, std::vector<Readout>{}) {}

Rig::Rig(const RigDescription& description, const std::vector<Readout>& readouts)
    : data_(std::make_shared<const Data>(rig_from(description, readouts))) {}

const RigDescription& Rig::description() const { return data_->description; }

std::vector<Readout> Rig::readouts() const {
  std::vector<Readout> readouts;
  for (const detail::RigCamera& camera : data_->rig.cameras) {
    if (camera.readout) readouts.push_back({camera.name, *camera.readout});
  }
  return readouts;
}

}  // namespace tagsmith
