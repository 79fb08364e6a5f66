// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/mounting.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "decoder/plates/drive_fit.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/assumptions.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t kMounting = 6;  // parameters of a camera: shift and turn

using Held = std::vector<std::array<bool, kMounting>>;  // by camera

// Nothing is known of parameters that are not held; of the lens what the rig states.
std::vector<ParameterSigmas> sigmas_for(const Rig& rig, const Held& held) {
  std::vector<ParameterSigmas> sigmas = stated_sigmas(rig);
  for (std::size_t c = 0; c < sigmas.size(); ++c) {
    for (std::size_t i = 0; i < kMounting; ++i) {
      sigmas[c][i] = held[c][i] ? 0 : i < 3 ? kFreePosition : kFreeAngle;
    }
  }
  return sigmas;
}

// The second fit starts from the first's result: covariances are valid for small turns.
std::optional<DriveFit> fit_twice(const Survey& survey, const Drive& drive, const Rig& start,
                                  const std::vector<ParameterSigmas>& sigmas) {
  const auto first = fit_drive(survey, drive, start, sigmas);
  if (!first) return std::nullopt;
  Rig near = start;
  for (std::size_t c = 0; c < near.cameras.size(); ++c) {
    near.cameras[c].vehicle_from_camera = first->rig.cameras[c].vehicle_from_camera;
  }
  return fit_drive(survey, drive, near, sigmas);
}

// --- covariances ---

// How a camera's coordinate moves when the vehicle's axes turn about this one: relative to the
// camera that is held in this coordinate, because that one does not move.
double shift_by_turn(const DriveFit& fitted, std::size_t camera, Index coordinate,
                     const Vector3d& axis) {
  const auto moved = [&](std::size_t c) {
    return axis.cross(fitted.rig.cameras[c].vehicle_from_camera.translation)[coordinate];
  };
  for (std::size_t c = 0; c < fitted.rig.cameras.size(); ++c) {
    const bool is_held = fitted.layout.places[c][static_cast<std::size_t>(coordinate)] < 0;
    if (is_held) return moved(camera) - moved(c);
  }
  return moved(camera);
}

// How a camera's six parameters move when the vehicle's axes turn; what is held does not.
Eigen::Matrix<double, 6, 3> by_turn_of_axes(const DriveFit& fitted, std::size_t camera) {
  const Matrix3d axes = vehicle_frame(VehiclePose{}).turn_axes;
  const Pose& pose = fitted.rig.cameras[camera].vehicle_from_camera;
  Eigen::Matrix<double, 6, 3> result = Eigen::Matrix<double, 6, 3>::Zero();
  for (Index a = 0; a < 3; ++a) {
    const Vector3d turn = pose.rotation.transpose() * axes.col(a);
    for (Index row = 0; row < 6; ++row) {
      if (fitted.layout.places[camera][static_cast<std::size_t>(row)] < 0) continue;
      result(row, a) = row < 3 ? shift_by_turn(fitted, camera, row, axes.col(a)) : turn[row - 3];
    }
  }
  return result;
}

// The covariance of a camera's six parameters in the vehicle's own axes: an error that all
// vehicles' attitudes share is an error of these axes, which the drive defines, not of the camera.
Eigen::Matrix<double, 6, 6> covariance_of(const DriveFit& fitted, std::size_t camera) {
  const MatrixXd& all = fitted.adjustment.calibration_covariance;
  MatrixXd by_all = MatrixXd::Zero(6, all.rows());
  for (std::size_t i = 0; i < kMounting; ++i) {
    const int place = fitted.layout.places[camera][i];
    if (place >= 0) by_all(static_cast<Index>(i), place) = 1;
  }
  by_all.rightCols<3>() = by_turn_of_axes(fitted, camera);
  return by_all * all * by_all.transpose();
}

// The covariance of a camera's six parameters from the uncertainty of the axes themselves, which
// the drive defines as the mean of its rows: from the rows' scatter.
Eigen::Matrix<double, 6, 6> covariance_of_axes(const DriveFit& fitted, std::size_t camera) {
  const Eigen::Matrix<double, 6, 3> by_axes = by_turn_of_axes(fitted, camera);
  return by_axes * fitted.mean_attitude_variance.asDiagonal() * by_axes.transpose();
}

// The camera's pose in the vehicle's own axes: in those of the fit the vehicles may, as a mean,
// stand askew, as far as the assumed height and stance allow.
Pose in_own_axes(const DriveFit& fitted, std::size_t camera) {
  const Vector3d turn = vehicle_frame(VehiclePose{}).turn_axes * fitted.mean_attitude;
  Pose pose = fitted.rig.cameras[camera].vehicle_from_camera;
  pose.translation += by_turn_of_axes(fitted, camera).topRows<3>() * fitted.mean_attitude;
  pose.rotation = rotation_of(turn) * pose.rotation;
  return pose;
}

// The derivatives of the angles by a small turn in camera axes.
Matrix3d angles_by_turn(const Pose& vehicle_from_camera) {
  constexpr double kStep = 1e-6;
  const MountingAngles at = mounting_angles(vehicle_from_camera);
  Matrix3d result;
  for (Index i = 0; i < 3; ++i) {
    Pose moved = vehicle_from_camera;
    moved.rotation *= rotation_of(kStep * Vector3d::Unit(i));
    const MountingAngles angles = mounting_angles(moved);
    const auto change = [](double to, double from) { return wrapped_angle(to - from) / kStep; };
    result.col(i) << change(angles.yaw, at.yaw), change(angles.pitch, at.pitch),
        change(angles.roll, at.roll);
  }
  return result;
}

// Holds the parameter that the drive determines least, if a tape or a protractor measures it
// better.
bool hold_worst(const DriveFit& fitted, Held& held) {
  constexpr double kAlike =
      1 + 1e-3;  // if two are equally well determined, the first, so that rounding does not decide
  const CalibrationSigma by_hand = usual_calibration(IntrinsicsSource::numbers, Camera{});
  double worst = 1;
  bool* to_hold = nullptr;
  for (std::size_t camera = 0; camera < held.size(); ++camera) {
    const Vector6 sigma = covariance_of(fitted, camera).diagonal().cwiseMax(0).cwiseSqrt();
    for (std::size_t i = 0; i < kMounting; ++i) {
      const double share =
          sigma[static_cast<Index>(i)] / (i < 3 ? by_hand.position : by_hand.angle);
      if (held[camera][i] || share <= kAlike * worst) continue;
      worst = share;
      to_hold = &held[camera][i];
    }
  }
  if (to_hold != nullptr) *to_hold = true;
  return to_hold != nullptr;
}

// --- ranges ---

std::vector<FittedRange> fit_ranges(const DriveFit& fitted, const Drive& drive,
                                    const Survey& survey) {
  constexpr double kSpread = 1.4826;    // standard deviations per median absolute deviation
  constexpr double kOfMedian = 1.2533;  // standard deviation of a median over that of a mean
  std::vector<FittedRange> result;
  for (const RigRange& range : fitted.rig.ranges) {
    std::vector<double> offsets;
    for (std::size_t s = 0; s < drive.rows.size(); ++s) {
      const auto measured = drive.rows[s]->ranges.find(range.name);
      const auto& vehicle = fitted.adjustment.vehicles[s];
      if (measured == drive.rows[s]->ranges.end() || !vehicle) continue;
      offsets.push_back(measured->second - observe_wall(survey.tunnel.centerline,
                                                        wall_of(survey.tunnel, range.wall),
                                                        vehicle->position)
                                               .distance);
    }
    if (offsets.empty()) continue;
    FittedRange fit{range.name, quantile(offsets, 0.5), 0, offsets.size()};
    for (double& offset : offsets) offset = std::abs(offset - fit.offset);
    const double spread = std::max(kSpread * quantile(offsets, 0.5), range.sigma);
    fit.sigma = kOfMedian * spread / std::sqrt(static_cast<double>(fit.rows));
    result.push_back(std::move(fit));
  }
  return result;
}

// --- the result ---

MountingFit result_of(const DriveFit& fitted, const Drive& drive, const Survey& survey,
                      const Held& held, const std::vector<std::size_t>& left_out) {
  MountingFit fit;
  fit.rows = drive.stations.size();
  fit.places_apart = fitted.places_apart;
  std::vector<std::size_t> tags(fitted.rig.cameras.size());
  std::size_t sightings = 0;
  for (std::size_t s = 0; s < drive.stations.size(); ++s) {
    for (const Sighting& sighting : drive.stations[s].sightings) {
      ++tags[sighting.camera];
      ++sightings;
    }
  }
  // Chi-square of everything, because where rows contradict each other the plates move before the
  // corners do. Priors add as many equations as they add unknowns: for the vehicle four a row.
  fit.chi_square = fitted.adjustment.chi_square;
  fit.degrees_of_freedom = static_cast<int>(8 * sightings + 4 * fit.rows) -
                           static_cast<int>(6 * fit.rows + fitted.layout.sigmas.size());
  fit.sigma_factor = std::sqrt(std::max(1.0, fit.chi_square / std::max(1, fit.degrees_of_freedom)));
  for (std::size_t c = 0; c < fitted.rig.cameras.size(); ++c) {
    const RigCamera& camera = fitted.rig.cameras[c];
    FittedMounting mounting{camera.name, in_own_axes(fitted, c)};
    const Eigen::Matrix<double, 6, 6> covariance =
        fit.sigma_factor * fit.sigma_factor * covariance_of(fitted, c) +
        covariance_of_axes(fitted, c);
    const Matrix3d by_turn = angles_by_turn(camera.vehicle_from_camera);
    const Matrix3d of_turn = covariance.bottomRightCorner<3, 3>();
    mounting.sigma << covariance.diagonal().head<3>(),
        (by_turn * of_turn * by_turn.transpose()).diagonal();
    mounting.sigma = mounting.sigma.cwiseMax(0).cwiseSqrt();
    mounting.held = held[c];
    mounting.tags = tags[c];
    mounting.left_out = left_out[c];
    fit.cameras.push_back(std::move(mounting));
  }
  fit.ranges = fit_ranges(fitted, drive, survey);
  return fit;
}

}  // namespace

Result<MountingFit> fit_mounting(std::span<const Observation> rows, const Survey& survey,
                                 const Rig& rig) {
  constexpr std::size_t kLeastRows = 3;
  constexpr double kMostFactor = 5;  // of the stated sigmas, which differ by camera and survey
  Drive drive = drive_of(rows, survey, rig);
  if (drive.stations.size() < kLeastRows) {
    return fail(fmt::format("{} of {} rows show tags of the survey, expected {} or more",
                            drive.stations.size(), rows.size(), kLeastRows));
  }
  Rig start = rig;
  Held held(rig.cameras.size());
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    if (!sees_anything(drive, camera)) held[camera].fill(true);
    start.cameras[camera].vehicle_from_camera.rotation =
        likely_attitude(survey, rig, drive, camera);
  }
  std::vector<std::size_t> left_out(rig.cameras.size());
  while (drive.stations.size() >= kLeastRows) {
    const auto fitted = fit_twice(survey, drive, start, sigmas_for(rig, held));
    if (!fitted) return fail("the mounting that fits the tags best was not found");
    const std::vector<LeftOut> out = leave_out_worst(*fitted, drive, usual_excess(*fitted, drive));
    for (const LeftOut& one : out) ++left_out[one.sighting.camera];
    if (!out.empty()) continue;
    if (hold_worst(*fitted, held)) continue;
    MountingFit fit = result_of(*fitted, drive, survey, held, left_out);
    if (fit.sigma_factor <= kMostFactor) return fit;
    return fail(fmt::format(
        "photos, survey and rig do not fit together: residuals are {:.0f} times what was "
        "stated; are the photos of each row taken together, and the tags where the "
        "survey has them?",
        fit.sigma_factor));
  }
  return fail("the tags contradict each other in too many rows");
}

}  // namespace tagsmith::detail
