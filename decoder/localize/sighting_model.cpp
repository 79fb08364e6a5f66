// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/sighting_model.hpp"

#include <algorithm>
#include <utility>

#include "decoder/localize/plate_pose.hpp"
#include "tagsmith/geometry/angle.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;
using CalibrationVector = Eigen::Matrix<double, kCalibrationCount, 1>;

CalibrationVector sigmas_of(const CalibrationSigma& sigma) {
  CalibrationVector sigmas;
  sigmas << sigma.position, sigma.position, sigma.position, sigma.angle, sigma.angle, sigma.angle,
      sigma.focal, sigma.center, sigma.center, sigma.radial, motion_sigmas(sigma.shutter),
      motion_sigmas(sigma.delay);
  return sigmas;
}

std::array<Vector3d, 4> corners_in_plate(const SightedPlate& plate) {
  return {Vector3d(0, 0, 0), Vector3d(plate.length, 0, 0), Vector3d(plate.length, plate.height, 0),
          Vector3d(0, plate.height, 0)};
}

}  // namespace

std::size_t plate_index(std::vector<SightedPlate>& plates, SightedPlate plate) {
  const auto found = std::ranges::find(plates, plate.name, &SightedPlate::name);
  if (found != plates.end()) return static_cast<std::size_t>(found - plates.begin());
  plates.push_back(std::move(plate));
  return plates.size() - 1;
}

std::optional<std::size_t> camera_index(const Rig& rig, std::string_view name) {
  const RigCamera* camera = find_camera(rig, name);
  if (camera == nullptr) return std::nullopt;
  return static_cast<std::size_t>(camera - rig.cameras.data());
}

Eigen::Matrix<double, 6, 1> pose_difference(const VehiclePose& from, const VehiclePose& to) {
  Eigen::Matrix<double, 6, 1> difference;
  difference << to.position - from.position, wrapped_angle(to.heading - from.heading),
      to.pitch - from.pitch, to.roll - from.roll;
  return difference;
}

CalibrationLayout calibration_layout_of_moment(const Rig& rig) {
  CalibrationLayout layout;
  for (const RigCamera& camera : rig.cameras) {
    const CalibrationVector sigmas = sigmas_of(camera.calibration_sigma);
    std::array<int, kCalibrationCount> places{};
    for (Index i = 0; i < kCalibrationCount; ++i) {
      places[static_cast<std::size_t>(i)] = -1;
      if (sigmas[i] == 0) continue;
      places[static_cast<std::size_t>(i)] = static_cast<int>(layout.sigmas.size());
      layout.sigmas.push_back(sigmas[i]);
    }
    layout.places.push_back(places);
  }
  return layout;
}

CalibrationLayout calibration_layout(const Rig& rig) {
  Rig driven = rig;
  for (RigCamera& camera : driven.cameras) {
    camera.calibration_sigma.shutter = camera.calibration_sigma.delay = 0;
  }
  return calibration_layout_of_moment(driven);
}

CalibratedCamera calibrated(const RigCamera& camera, const CalibrationLayout& layout,
                            std::size_t index, const VectorXd& calibration) {
  CalibratedCamera result{camera.camera, camera.vehicle_from_camera};
  if (calibration.size() == 0) return result;
  CalibrationVector errors = CalibrationVector::Zero();
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const int place = layout.places[index][i];
    if (place >= 0) errors[static_cast<Index>(i)] = calibration[place];
  }
  result.vehicle_from_camera.translation += errors.head<3>();
  result.vehicle_from_camera.rotation *= rotation_of(errors.segment<3>(3));
  result.camera.fx *= 1 + errors[6];
  result.camera.fy *= 1 + errors[6];
  result.camera.cx += errors[7];
  result.camera.cy += errors[8];
  result.camera.distortion[0] += errors[9];
  result.motion = errors.segment<6>(kMotion);
  result.delay = errors.segment<6>(kDelay);
  return result;
}

std::optional<SightingRows> sighting_rows(const Rig& rig, const CalibrationLayout& layout,
                                          const VectorXd& calibration, const VehicleFrame& vehicle,
                                          const SightedPlate& plate, std::size_t camera) {
  const CalibratedCamera seen_by = calibrated(rig.cameras[camera], layout, camera, calibration);
  SightingRows rows;
  Index row = 0;
  for (const Vector3d& corner : corners_in_plate(plate)) {
    const auto observed = observe_point(seen_by.camera, seen_by.vehicle_from_camera, vehicle,
                                        plate.world_from_plate, corner);
    if (!observed) return std::nullopt;
    rows.predicted.segment<2>(row) =
        observed->pixel + observed->by_motion * seen_by.motion + observed->by_delay * seen_by.delay;
    rows.by_vehicle.middleRows<2>(row) = observed->by_vehicle;
    rows.by_plate.middleRows<2>(row) = observed->by_plate;
    rows.by_calibration.middleRows<2>(row) << observed->by_mounting, observed->by_intrinsics,
        observed->by_motion, observed->by_delay;
    row += 2;
  }
  return rows;
}

Eigen::Matrix<double, kSightingRows, kMotions> by_motion_sigmas(const SightingRows& rows,
                                                                const RigCamera& camera) {
  return rows.by_calibration.rightCols<kMotions>() *
         sigmas_of(camera.calibration_sigma).tail<kMotions>().asDiagonal();
}

std::optional<double> factor_to_explain(double chi_square) {
  constexpr int kFree = 2;
  constexpr double kMost = 100;
  if (chi_square <= kCornersAsStated) return 1;
  return chi_square <= kFree * kMost ? std::optional(chi_square / kFree) : std::nullopt;
}

std::optional<std::array<Pose, 2>> camera_poses_from(const Camera& camera,
                                                     const SightedPlate& plate,
                                                     const Sighting& sighting) {
  std::array<Vector3d, 4> rays;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto ray =
        ray_through(camera, sighting.pixels.segment<2>(static_cast<Eigen::Index>(2 * i)));
    if (!ray) return std::nullopt;
    rays[i] = *ray;
  }
  const auto camera_from_plate = plate_poses(rays, plate.length, plate.height);
  if (!camera_from_plate) return std::nullopt;
  return std::array{plate.world_from_plate * inverse((*camera_from_plate)[0]),
                    plate.world_from_plate * inverse((*camera_from_plate)[1])};
}

std::optional<std::array<VehiclePose, 2>> vehicle_poses_from(const Rig& rig,
                                                             const SightedPlate& plate,
                                                             const Sighting& sighting) {
  const RigCamera& camera = rig.cameras[sighting.camera];
  const auto world_from_camera = camera_poses_from(camera.camera, plate, sighting);
  if (!world_from_camera) return std::nullopt;
  const Pose camera_from_vehicle = inverse(camera.vehicle_from_camera);
  return std::array{vehicle_pose_of((*world_from_camera)[0] * camera_from_vehicle),
                    vehicle_pose_of((*world_from_camera)[1] * camera_from_vehicle)};
}

}  // namespace tagsmith::detail
