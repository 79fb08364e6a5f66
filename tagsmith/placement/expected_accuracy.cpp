// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/expected_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The inverse of a symmetric matrix; nothing unless it is positive definite (its leading minors
// are).
std::optional<Matrix3d> inverse_in_closed_form(const Matrix3d& matrix) {
  const double minor = matrix(0, 0) * matrix(1, 1) - matrix(0, 1) * matrix(1, 0);
  const double scale = matrix(0, 0) * matrix(1, 1) * matrix(2, 2);
  constexpr double kSingular = 1e-14;  // of the product of the diagonal
  if (!(matrix(0, 0) > 0 && minor > 0 && matrix.determinant() > kSingular * scale)) {
    return std::nullopt;
  }
  return matrix.inverse();
}

constexpr Eigen::Index kVehicleCount = vehicle_parameter::kCount;
constexpr Eigen::Index kFixedParameters = 9;  // of a camera's calibration
constexpr Eigen::Index kLensParameters = 10;  // and the distortion
// And the vehicle's motion while a rolling shutter passes over the image, and until it is taken.
constexpr Eigen::Index kCalibrationParameters = 22;
constexpr Eigen::Index kPlateRows = 8;
constexpr Eigen::Index kPlateParameters = 7;  // its place, its attitude, where its edges are seen

// Derivatives of a plate's corners in one image; those by uncertain quantities in units of their
// standard deviations.
struct CornerRows {
  Eigen::Matrix<double, kPlateRows, kVehicleCount> by_vehicle;
  Eigen::Matrix<double, kPlateRows, kPlateParameters> by_plate;
  Eigen::Matrix<double, kPlateRows, kCalibrationParameters> by_calibration;
};

// Rows of corners that cannot be seen are zero.
CornerRows corner_rows(const Survey& survey, const Rig& rig, const VehicleFrame& vehicle,
                       const PlateSight& sight, const AccuracyOptions& options) {
  const TagTemplate& tag = survey.tag_template;
  const PlacedTag& placed = survey.tags[sight.tag];
  const RigCamera& camera = rig.cameras[sight.camera];
  const CalibrationSigma& sigma = camera.calibration_sigma;
  const double driven = options.speed * camera.readout.value_or(0);
  const double delayed = options.speed * camera.delay.value_or(0);
  CornerRows rows;
  rows.by_vehicle.setZero();
  rows.by_plate.setZero();
  rows.by_calibration.setZero();
  const double length = tag.frame_inner_length;
  const double height = tag.frame_inner_height;
  const Vector3d corners[] = {{0, 0, 0}, {length, 0, 0}, {length, height, 0}, {0, height, 0}};
  Eigen::Matrix<double, kPlateRows, 1> pixels;
  bool all_seen = true;
  Eigen::Index row = 0;
  for (const Vector3d& corner : corners) {
    const auto point = observe_point(camera.camera, camera.vehicle_from_camera, vehicle,
                                     placed.world_from_plate, corner);
    row += 2;
    all_seen = all_seen && point;
    if (!point) continue;
    pixels.segment<2>(row - 2) = point->pixel;
    rows.by_vehicle.middleRows<2>(row - 2) = point->by_vehicle;
    rows.by_plate.middleRows<2>(row - 2).leftCols<6>()
        << placed.sigma * point->by_plate.leftCols<3>(),
        survey.angle_sigma * point->by_plate.rightCols<3>();
    rows.by_calibration.middleRows<2>(row - 2) << sigma.position * point->by_mounting.leftCols<3>(),
        sigma.angle * point->by_mounting.rightCols<3>(),
        sigma.focal * point->by_intrinsics.leftCols<1>(),
        sigma.center * point->by_intrinsics.middleCols<2>(1),
        sigma.radial * point->by_intrinsics.rightCols<1>(),
        point->by_motion * motion_sigmas(driven).asDiagonal(),
        point->by_delay * motion_sigmas(delayed).asDiagonal();
  }
  if (all_seen) rows.by_plate.rightCols<1>() = sigma.edge * by_outward_edges(pixels);
  return rows;
}

// Adds one tag's information about the vehicle and all cameras' calibrations.
void add_tag(const Survey& survey, const Rig& rig, const VehicleFrame& vehicle,
             std::span<const PlateSight> sights, std::size_t tag, const AccuracyOptions& options,
             Eigen::MatrixXd& information) {
  const auto count = std::ranges::count(sights, tag, &PlateSight::tag);
  const Eigen::Index size = kPlateRows * static_cast<Eigen::Index>(count);
  Eigen::MatrixXd by_all = Eigen::MatrixXd::Zero(size, information.cols());
  Eigen::MatrixXd by_plate(size, kPlateParameters);
  Eigen::VectorXd variance(size);
  Eigen::Index row = 0;
  for (const PlateSight& sight : sights) {
    if (sight.tag != tag) continue;
    const CornerRows rows = corner_rows(survey, rig, vehicle, sight, options);
    const double sigma = expected_corner_sigma(rig, sight, options);
    by_all.block<kPlateRows, kVehicleCount>(row, 0) = rows.by_vehicle;
    by_all.block<kPlateRows, kCalibrationParameters>(
        row, kVehicleCount + kCalibrationParameters * static_cast<Eigen::Index>(sight.camera)) =
        rows.by_calibration;
    by_plate.middleRows<kPlateRows>(row) = rows.by_plate;
    variance.segment<kPlateRows>(row).setConstant(sigma * sigma);
    row += kPlateRows;
  }
  Eigen::MatrixXd covariance =
      propagated_variances(by_plate, Eigen::VectorXd::Ones(by_plate.cols()));
  covariance.diagonal() += variance;
  if (whiten(by_all, covariance)) information += gram(by_all);
}

bool sees_a_tag_twice(std::span<const PlateSight> sights) {
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const auto earlier = sights.first(i);
    if (std::ranges::find(earlier, sights[i].tag, &PlateSight::tag) != earlier.end()) return true;
  }
  return false;
}

// The information of each camera by itself, its calibration taken out, for sights of which no two
// share a plate: the same as all together, and several times as fast. Of the calibration's
// parameters the first ones count.
template <Eigen::Index kParameters>
VehicleCovariance sum_of_cameras(const Survey& survey, const Rig& rig, const VehicleFrame& vehicle,
                                 std::span<const PlateSight> sights,
                                 const AccuracyOptions& options) {
  constexpr Eigen::Index kCount = kVehicleCount + kParameters;
  VehicleCovariance sum = VehicleCovariance::Zero();
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    Eigen::Matrix<double, kCount, kCount> information =
        Eigen::Matrix<double, kCount, kCount>::Zero();
    information.diagonal().template tail<kParameters>().setOnes();
    for (const PlateSight& sight : sights) {
      if (sight.camera != camera) continue;
      const CornerRows rows = corner_rows(survey, rig, vehicle, sight, options);
      const double sigma = expected_corner_sigma(rig, sight, options);
      Eigen::Matrix<double, kPlateRows, kPlateRows> covariance =
          rows.by_plate.lazyProduct(rows.by_plate.transpose());
      covariance.diagonal().array() += sigma * sigma;
      Eigen::Matrix<double, kPlateRows, kCount> by_all;
      by_all << rows.by_vehicle, rows.by_calibration.leftCols<kParameters>();
      covariance.llt().matrixL().solveInPlace(by_all);
      information += by_all.transpose().lazyProduct(by_all);  // small: no kernels of large ones
    }
    const Eigen::Matrix<double, kVehicleCount, kParameters> shared =
        information.template topRightCorner<kVehicleCount, kParameters>();
    sum += information.template topLeftCorner<kVehicleCount, kVehicleCount>() -
           shared * information.template bottomRightCorner<kParameters, kParameters>().llt().solve(
                        shared.transpose());
  }
  return sum;
}

}  // namespace

double expected_corner_sigma(const Rig& rig, const PlateSight& sight,
                             const AccuracyOptions& options) {
  if (options.corner_sigma_px) return *options.corner_sigma_px;
  const double moved = options.speed * rig.cameras[sight.camera].exposure.value_or(0);
  const double motion = sight.smear_px * moved;
  const double blur = std::sqrt(sight.blur_px * sight.blur_px + motion * motion / 12);
  return corner_sigma_px(sight.effective_px, blur);
}

VehicleCovariance sights_information(const Survey& survey, const Rig& rig,
                                     const VehicleFrame& vehicle,
                                     std::span<const PlateSight> sights,
                                     const AccuracyOptions& options) {
  if (!sees_a_tag_twice(sights)) {
    const auto bends = [](const RigCamera& camera) { return camera.calibration_sigma.radial > 0; };
    if (has_rolling_shutter(rig) || has_delay(rig)) {
      return sum_of_cameras<kCalibrationParameters>(survey, rig, vehicle, sights, options);
    }
    return std::ranges::any_of(rig.cameras, bends)
               ? sum_of_cameras<kLensParameters>(survey, rig, vehicle, sights, options)
               : sum_of_cameras<kFixedParameters>(survey, rig, vehicle, sights, options);
  }
  const Eigen::Index calibrated =
      kCalibrationParameters * static_cast<Eigen::Index>(rig.cameras.size());
  Eigen::MatrixXd information =
      Eigen::MatrixXd::Zero(kVehicleCount + calibrated, kVehicleCount + calibrated);
  information.diagonal().tail(calibrated).setOnes();
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const auto earlier = sights.first(i);
    const std::size_t tag = sights[i].tag;
    if (std::ranges::find(earlier, tag, &PlateSight::tag) != earlier.end()) continue;
    add_tag(survey, rig, vehicle, sights, tag, options, information);
  }
  const Eigen::MatrixXd shared = information.topRightCorner(kVehicleCount, calibrated);
  return information.topLeftCorner<kVehicleCount, kVehicleCount>() -
         VehicleCovariance(shared.lazyProduct(solve_symmetric(
             information.bottomRightCorner(calibrated, calibrated), shared.transpose())));
}

VehicleCovariance rig_information(const Survey& survey, const Rig& rig,
                                  const CenterlinePoint& floor, const VehiclePose& pose) {
  VehicleCovariance information = VehicleCovariance::Zero();
  const Vector3d sigmas(rig.height_sigma, rig.pitch_sigma, rig.roll_sigma);
  const ObservedStance stance = observe_stance(floor, pose);
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (sigmas[i] <= 0) continue;
    const Eigen::Matrix<double, 1, 6> row = stance.by_vehicle.row(i) / sigmas[i];
    information.noalias() += row.transpose() * row;
  }
  for (const RigRange& range : rig.ranges) {
    const ObservedWall wall =
        observe_wall(survey.tunnel.centerline, wall_of(survey.tunnel, range.wall), pose.position);
    if (wall.distance < range.min || wall.distance > range.max) continue;
    information.topLeftCorner<3, 3>() +=
        wall.by_position * wall.by_position.transpose() / (range.sigma * range.sigma);
  }
  return information;
}

std::optional<VehicleCovariance> covariance_from(const VehicleCovariance& information) {
  // By blocks of three, whose inverses have a closed form: millions of poses are planned.
  const std::optional<Matrix3d> of_place =
      inverse_in_closed_form(information.topLeftCorner<3, 3>());
  if (!of_place) return std::nullopt;
  const Matrix3d shared = information.topRightCorner<3, 3>();
  const Matrix3d carried = *of_place * shared;
  const std::optional<Matrix3d> attitude =
      inverse_in_closed_form(information.bottomRightCorner<3, 3>() - shared.transpose() * carried);
  if (!attitude) return std::nullopt;
  VehicleCovariance covariance;
  const Matrix3d mixed = -carried * *attitude;
  covariance << *of_place - mixed * carried.transpose(), mixed, mixed.transpose(), *attitude;
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace tagsmith::detail
