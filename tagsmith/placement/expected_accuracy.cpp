// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/expected_accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace tagsmith {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double corner_sigma(const PlateSight& sight, const AccuracyOptions& options) {
  if (options.corner_sigma_px) return *options.corner_sigma_px;
  const double motion = sight.smear_px * options.moved;
  const double blur = std::sqrt(sight.blur_px * sight.blur_px + motion * motion / 12);
  return corner_sigma_px(sight.module_px, blur);
}

// A sight with its distance D from O to P; the method takes the camera to be at O.
struct RangedSight {
  const PlateSight* sight = nullptr;
  const PlacedTag* tag = nullptr;
  double distance = 0;
};

struct Pair {
  RangedSight left;
  RangedSight right;
};

// Smaller is better, as localize_by_paper ranks.
auto rank_of(const Pair& pair) {
  const PlacedTag& left = *pair.left.tag;
  const PlacedTag& right = *pair.right.tag;
  const bool is_one_pair = left.pair == right.pair;
  const long apart_mm =
      is_one_pair ? 0 : std::lround(1000 * std::abs(left.chainage - right.chainage));
  return std::tuple(!is_one_pair, apart_mm, pair.left.distance + pair.right.distance);
}

bool is_turned(const Survey& survey, const PlateSight& sight) {
  return is_turned_from_wall(survey.tunnel, survey.tag_template, survey.tags[sight.tag]);
}

std::optional<Pair> choose_pair(const Survey& survey, const Vector3d& position,
                                std::span<const PlateSight> sights) {
  const auto ranged = [&](const PlateSight& sight) {
    const PlacedTag& tag = survey.tags[sight.tag];
    return RangedSight{&sight, &tag, (tag.world_from_plate.translation - position).norm()};
  };
  std::optional<Pair> best;
  for (const PlateSight& left : sights) {
    if (survey.tags[left.tag].side != Side::left || is_turned(survey, left)) continue;
    for (const PlateSight& right : sights) {
      if (survey.tags[right.tag].side != Side::right || left.camera == right.camera) continue;
      if (is_turned(survey, right)) continue;
      const Pair pair{ranged(left), ranged(right)};
      if (!best || rank_of(pair) < rank_of(*best)) best = pair;
    }
  }
  return best;
}

const RigRange* left_range(const Rig& rig, double distance) {
  const RigRange* best = nullptr;
  for (const RigRange& range : rig.ranges) {
    const bool usable = range.wall == Side::left && distance >= range.min && distance <= range.max;
    if (usable && (best == nullptr || range.sigma < best->sigma)) best = &range;
  }
  return best;
}

// (10): D is inversely proportional to |P'Q'|.
double distance_sigma(const Survey& survey, const Rig& rig, const Pose& world_from_vehicle,
                      const RangedSight& ranged, const AccuracyOptions& options) {
  const RigCamera& camera = rig.cameras[ranged.sight->camera];
  const Pose camera_from_world = inverse(world_from_vehicle * camera.vehicle_from_camera);
  const Pose camera_from_plate = camera_from_world * ranged.tag->world_from_plate;
  const double edge = survey.tag_template.frame_inner_height;
  const auto p = project(camera.camera, camera_from_plate.translation);
  const auto q = project(camera.camera, camera_from_plate * Vector3d(0, edge, 0));
  if (!p || !q) return 0;
  const double by_corners =
      ranged.distance * std::sqrt(2.0) * corner_sigma(*ranged.sight, options) / (*q - *p).norm();
  return std::hypot(by_corners, ranged.tag->sigma);
}

// Share of measurements with r^2 < (a / tan(theta))^2, the root in (18), when d, D1 and D2 have
// these standard deviations. a and r are those of the true place; a moves with d by 1 / cos(theta)
// and with D by D / L, r with D by about D / r.
double no_solution_share(const Vector3d& p1, const Vector3d& p2, const Vector3d& position,
                         double wall_distance, double pair_angle, const Vector3d& sigmas) {
  const Vector3d line = p2 - p1;
  const double length = line.norm();
  const double distance1 = (position - p1).norm();
  const double distance2 = (position - p2).norm();
  const double p1e = (position - p1).dot(line) / length;
  const double r = std::sqrt(std::max(0.0, distance1 * distance1 - p1e * p1e));
  const double a = p1e - wall_distance / std::cos(pair_angle);
  const double limit = r * std::tan(pair_angle);
  if (r < 1e-9) return 1;
  // What lies between a and either limit, and how that varies.
  const auto share_beyond = [&](double way) {
    const double by_d = 1 / std::cos(pair_angle);
    const double by_1 = way * distance1 / length -
                        std::tan(pair_angle) * (distance1 - p1e * distance1 / length) / r;
    const double by_2 =
        -way * distance2 / length - std::tan(pair_angle) * (p1e * distance2 / length) / r;
    const double sigma = Vector3d(by_1 * sigmas[0], by_2 * sigmas[1], by_d * sigmas[2]).norm();
    const double room = limit - way * a;
    if (sigma <= 0) return room < 0 ? 1.0 : 0.0;
    return 0.5 * std::erfc(room / sigma * std::numbers::sqrt2 / 2);
  };
  return std::min(1.0, share_beyond(1) + share_beyond(-1));
}

// The inverse of a symmetric matrix; nothing unless it is positive definite (its leading minors
// are).
std::optional<Matrix3d> inverse_of_positive(const Matrix3d& matrix) {
  const double minor = matrix(0, 0) * matrix(1, 1) - matrix(0, 1) * matrix(1, 0);
  const double scale = matrix(0, 0) * matrix(1, 1) * matrix(2, 2);
  constexpr double kSingular = 1e-14;  // of the product of the diagonal
  if (!(matrix(0, 0) > 0 && minor > 0 && matrix.determinant() > kSingular * scale)) {
    return std::nullopt;
  }
  return matrix.inverse();
}

}  // namespace

VehicleCovariance corner_information(const Survey& survey, const Rig& rig,
                                     const VehicleFrame& vehicle, const PlateSight& sight,
                                     const AccuracyOptions& options) {
  const TagTemplate& tag = survey.tag_template;
  const RigCamera& camera = rig.cameras[sight.camera];
  const Pose& world_from_plate = survey.tags[sight.tag].world_from_plate;
  VehicleCovariance information = VehicleCovariance::Zero();
  for (const double x : {0.0, tag.frame_inner_length}) {
    for (const double y : {0.0, tag.frame_inner_height}) {
      const auto point = observe_point_from_vehicle(camera.camera, camera.vehicle_from_camera,
                                                    vehicle, world_from_plate * Vector3d(x, y, 0));
      if (!point) continue;
      information.noalias() += point->by_vehicle.transpose() * point->by_vehicle;
    }
  }
  const double sigma = corner_sigma(sight, options);
  return information / (sigma * sigma);
}

VehicleCovariance with_survey_error(const VehicleCovariance& information, double survey_sigma) {
  if (survey_sigma <= 0) return information;
  // A shift of the plate acts as the opposite shift of the vehicle, so that the information on it
  // is in the same matrix; it is taken out by its Schur complement.
  const Matrix3d on_shift =
      information.topLeftCorner<3, 3>() + Matrix3d::Identity() / (survey_sigma * survey_sigma);
  const Eigen::Matrix<double, 6, 3> shared = information.leftCols<3>();
  return information - shared * on_shift.inverse() * shared.transpose();
}

VehicleCovariance rig_information(const Survey& survey, const Rig& rig, const VehiclePose& pose) {
  VehicleCovariance information = VehicleCovariance::Zero();
  information(vehicle_parameter::kRoll, vehicle_parameter::kRoll) =
      1 / (rig.roll_sigma * rig.roll_sigma);
  information(vehicle_parameter::kPitch, vehicle_parameter::kPitch) =
      1 / (rig.pitch_sigma * rig.pitch_sigma);
  if (rig.height_sigma > 0) {
    information(vehicle_parameter::kZ, vehicle_parameter::kZ) =
        1 / (rig.height_sigma * rig.height_sigma);
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
  const std::optional<Matrix3d> of_place = inverse_of_positive(information.topLeftCorner<3, 3>());
  if (!of_place) return std::nullopt;
  const Matrix3d shared = information.topRightCorner<3, 3>();
  const Matrix3d carried = *of_place * shared;
  const std::optional<Matrix3d> attitude =
      inverse_of_positive(information.bottomRightCorner<3, 3>() - shared.transpose() * carried);
  if (!attitude) return std::nullopt;
  VehicleCovariance covariance;
  const Matrix3d mixed = -carried * *attitude;
  covariance << *of_place - mixed * carried.transpose(), mixed, mixed.transpose(), *attitude;
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

std::optional<PaperExpectation> expect_by_paper(const Survey& survey, const Rig& rig,
                                                const VehiclePose& pose,
                                                std::span<const PlateSight> sights,
                                                const AccuracyOptions& options) {
  const std::optional<Pair> pair = choose_pair(survey, pose.position, sights);
  if (!pair) return std::nullopt;
  const ObservedWall wall =
      observe_wall(survey.tunnel.centerline, survey.tunnel.left, pose.position);
  const RigRange* range = left_range(rig, wall.distance);
  if (range == nullptr) return std::nullopt;
  const Pose from_vehicle = world_from_vehicle(pose);
  const Vector3d p1 = pair->left.tag->world_from_plate.translation;
  const Vector3d p2 = pair->right.tag->world_from_plate.translation;
  const Vector3d sigmas(distance_sigma(survey, rig, from_vehicle, pair->left, options),
                        distance_sigma(survey, rig, from_vehicle, pair->right, options),
                        range->sigma);
  // d is taken for the distance to the plane of the left plate, along the pair's own cross section.
  const Vector3d along = (pair->left.tag->world_from_plate.rotation.col(0) -
                          pair->right.tag->world_from_plate.rotation.col(0))
                             .normalized();
  const Vector3d across = along.cross(Vector3d::UnitZ());
  Matrix3d derivative;
  derivative.row(0) = (pose.position - p1).normalized().transpose();
  derivative.row(1) = (pose.position - p2).normalized().transpose();
  derivative.row(2) = across.transpose();
  const Eigen::FullPivLU<Matrix3d> factors(derivative);
  if (!factors.isInvertible()) return std::nullopt;
  const Matrix3d inverse_derivative = factors.inverse();
  PaperExpectation expectation;
  expectation.covariance =
      inverse_derivative * sigmas.cwiseAbs2().asDiagonal() * inverse_derivative.transpose();
  const double stagger = std::abs((p2 - p1).dot(along));
  const double pair_angle =
      std::atan2(stagger, pair_width(survey.tunnel, *pair->left.tag, *pair->right.tag));
  expectation.magnification = 1 / std::tan(pair_angle);
  expectation.no_solution_share =
      no_solution_share(p1, p2, pose.position, wall.distance, pair_angle, sigmas);
  return expectation;
}

}  // namespace tagsmith
