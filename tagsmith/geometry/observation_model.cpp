// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/observation_model.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "tagsmith/geometry/side_line.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// cross_matrix(a) * b = a x b.
Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d matrix;
  matrix << 0, -a.z(), a.y(),  //
      a.z(), 0, -a.x(),        //
      -a.y(), a.x(), 0;
  return matrix;
}

double yaw_of(double heading) { return std::numbers::pi / 2 - heading; }

}  // namespace

Pose world_from_vehicle(const VehiclePose& vehicle) {
  return {rotation_from_yaw_pitch_roll(yaw_of(vehicle.heading), vehicle.pitch, vehicle.roll),
          vehicle.position};
}

VehiclePose vehicle_pose_of(const Pose& world_from_vehicle) {
  const Matrix3d& r = world_from_vehicle.rotation;
  VehiclePose vehicle;
  vehicle.position = world_from_vehicle.translation;
  vehicle.heading = std::atan2(r(0, 0), r(1, 0));
  vehicle.pitch = std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2)));
  vehicle.roll = std::atan2(r(2, 1), r(2, 2));
  return vehicle;
}

Eigen::Matrix<double, 6, 1> motion_sigmas(double way) {
  constexpr double kSway = 0.1;
  constexpr double kRadius = 10;
  Eigen::Matrix<double, 6, 1> sigmas;
  sigmas << way, kSway * way, kSway * way, Vector3d::Constant(way / kRadius);
  return sigmas;
}

VehicleFrame vehicle_frame(const VehiclePose& vehicle) {
  VehicleFrame frame;
  frame.world_from_vehicle = world_from_vehicle(vehicle);
  // Rz(yaw) Ry(pitch) Rx(roll): what stands to the right of a factor carries its axis over.
  const Vector3d up = frame.world_from_vehicle.rotation.row(2);
  frame.turn_axes << -up, Vector3d(0, std::cos(vehicle.roll), -std::sin(vehicle.roll)),
      Vector3d::UnitX();
  return frame;
}

std::optional<ObservedPoint> observe_point(const Camera& camera, const Pose& vehicle_from_camera,
                                           const VehicleFrame& vehicle,
                                           const Pose& world_from_plate,
                                           const Vector3d& point_in_plate) {
  const Pose& world_from_vehicle = vehicle.world_from_vehicle;
  const Matrix3d vehicle_from_world = world_from_vehicle.rotation.transpose();
  const Matrix3d camera_from_vehicle = vehicle_from_camera.rotation.transpose();
  const Vector3d in_vehicle =
      vehicle_from_world * (world_from_plate * point_in_plate - world_from_vehicle.translation);
  const Vector3d in_camera = camera_from_vehicle * (in_vehicle - vehicle_from_camera.translation);
  const std::optional<Projection> projection = project_with_derivative(camera, in_camera);
  if (!projection) return std::nullopt;
  const Eigen::Matrix<double, 2, 3> by_vehicle_point = projection->by_point * camera_from_vehicle;
  const Eigen::Matrix<double, 2, 3> by_world_point = by_vehicle_point * vehicle_from_world;
  ObservedPoint observed;
  observed.pixel = projection->pixel;
  observed.by_vehicle << -by_world_point,
      by_vehicle_point * (cross_matrix(in_vehicle) * vehicle.turn_axes);
  observed.by_plate << by_world_point,
      -by_world_point * world_from_plate.rotation * cross_matrix(point_in_plate);
  observed.by_mounting << -by_vehicle_point, projection->by_point * cross_matrix(in_camera);
  observed.by_intrinsics << observed.pixel - Eigen::Vector2d(camera.cx, camera.cy),
      Eigen::Matrix2d::Identity(), projection->by_k1;
  // The vehicle is at its stated place when the middle row is exposed.
  const double rows_later = (observed.pixel.y() - (camera.height - 1) / 2.0) / camera.height;
  observed.by_delay << observed.by_mounting.leftCols<3>(),
      observed.by_mounting.rightCols<3>() * camera_from_vehicle -
          observed.by_mounting.leftCols<3>() * cross_matrix(vehicle_from_camera.translation);
  observed.by_motion = rows_later * observed.by_delay;
  return observed;
}

ObservedWall observe_wall(const Centerline& centerline, const ChainageProfile& wall_offset,
                          const Vector3d& position) {
  const CenterlineAddress address = centerline.locate(position.head<2>());
  const double abreast = wall_offset.at(address.chainage);
  const double towards = abreast < 0 ? -1.0 : 1.0;
  const double distance = towards * (abreast - address.offset);
  const Vector3d across = -towards * right_of(centerline.at(address.chainage).heading);
  if (wall_offset.is_constant()) return {distance, across};
  const Eigen::Vector2d foot = nearest_on_side(centerline, wall_offset, position.head<2>());
  const double sign = distance < 0 ? -1.0 : 1.0;
  const Eigen::Vector2d way = position.head<2>() - foot;
  const double length = way.norm();
  constexpr double kAtWall = 1e-9;
  if (length < kAtWall) return {sign * length, across};
  return {sign * length, Vector3d(sign * way.x() / length, sign * way.y() / length, 0)};
}

Eigen::Matrix<double, 8, 1> by_outward_edges(const Eigen::Matrix<double, 8, 1>& corners) {
  Eigen::Matrix<double, 8, 1> shift;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Vector2d corner = corners.segment<2>(2 * i);
    const Eigen::Vector2d before = corner - corners.segment<2>(2 * ((i + 3) % 4));
    const Eigen::Vector2d after = corners.segment<2>(2 * ((i + 1) % 4)) - corner;
    Eigen::Matrix2d normals;  // of both sides that meet here, outward of a clockwise outline
    normals << before.y() / before.norm(), -before.x() / before.norm(), after.y() / after.norm(),
        -after.x() / after.norm();
    shift.segment<2>(2 * i) = normals.inverse() * Eigen::Vector2d(1, 1);
  }
  return shift;
}

}  // namespace tagsmith::detail
