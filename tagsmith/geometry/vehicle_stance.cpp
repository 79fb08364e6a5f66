// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/vehicle_stance.hpp"

#include <cmath>

namespace tagsmith::detail {

VehiclePose vehicle_on_floor(const CenterlinePoint& floor, const FloorStance& stance) {
  VehiclePose vehicle;
  vehicle.position = floor.position + stance.lateral * right_of(floor.heading) +
                     stance.height * Eigen::Vector3d::UnitZ();
  vehicle.heading = floor.heading + stance.yaw;
  vehicle.pitch = stance.pitch;
  vehicle.roll = stance.roll;
  if (floor.grade != 0) {
    vehicle.pitch -= std::atan(floor.grade * std::cos(stance.yaw));
    vehicle.roll += std::atan(floor.grade * std::sin(stance.yaw));
  }
  return vehicle;
}

ObservedStance observe_stance(const Centerline& centerline, const VehiclePose& vehicle) {
  return observe_stance(centerline.at(centerline.locate(vehicle.position.head<2>()).chainage),
                        vehicle);
}

ObservedStance observe_stance(const CenterlinePoint& floor, const VehiclePose& vehicle) {
  using namespace vehicle_parameter;
  const double yaw = vehicle.heading - floor.heading;
  const double ahead = floor.grade * std::cos(yaw);
  const double to_left = floor.grade * std::sin(yaw);
  ObservedStance stance;
  stance.height_pitch_roll << vehicle.position.z() - floor.position.z(),
      vehicle.pitch + std::atan(ahead), vehicle.roll - std::atan(to_left);
  stance.by_vehicle.block<1, 3>(0, kX) =
      (Eigen::Vector3d::UnitZ() - floor.grade * direction_of(floor.heading)).transpose();
  stance.by_vehicle(1, kPitch) = 1;
  stance.by_vehicle(1, kHeading) = -to_left / (1 + ahead * ahead);
  stance.by_vehicle(2, kRoll) = 1;
  stance.by_vehicle(2, kHeading) = -ahead / (1 + to_left * to_left);
  return stance;
}

}  // namespace tagsmith::detail
