// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/vehicle_stance.hpp"

#include <cmath>

#include <doctest/doctest.h>

using namespace tagsmith::detail;
using Eigen::Vector3d;

TEST_CASE("a vehicle follows its floor: uphill nose up, across the slope it leans") {
  const Centerline line({1, 2, 3}, 0.3, {{10, 0, 0.1}});
  const CenterlinePoint floor = line.at(4);
  const VehiclePose uphill = vehicle_on_floor(floor, {.height = 0.5});
  // Its x axis lies along the slope, its y axis is level.
  const Pose pose = world_from_vehicle(uphill);
  CHECK(pose.rotation(2, 0) == doctest::Approx(std::sin(std::atan(0.1))));
  CHECK(pose.rotation(2, 1) == doctest::Approx(0));
  CHECK((uphill.position - floor.position - Vector3d(0, 0, 0.5)).norm() < 1e-12);
  // Turned by a quarter to the right, the slope rises to its left.
  const VehiclePose across = vehicle_on_floor(floor, {.yaw = std::acos(0.0)});
  CHECK(across.pitch == doctest::Approx(0));
  CHECK(world_from_vehicle(across).rotation(2, 1) == doctest::Approx(std::sin(std::atan(0.1))));
}

TEST_CASE("a stance seen is the stance taken, and its derivatives are those of differences") {
  const Centerline line({0, 0, 0}, -0.4, {{5, 0.05, 0.12}, {5, -0.08, -0.2}});
  for (const double chainage : {1.0, 4.0, 7.0}) {
    const FloorStance taken{0.7, 0.4, 0.3, 0.05, -0.02};
    const VehiclePose vehicle = vehicle_on_floor(line.at(chainage), taken);
    const ObservedStance seen = observe_stance(line, vehicle);
    CHECK((seen.height_pitch_roll - Vector3d(0.7, 0.05, -0.02)).norm() < 1e-9);
    for (int i = 0; i < vehicle_parameter::kCount; ++i) {
      constexpr double kStep = 1e-6;
      const auto stepped = [&](double step) {
        VehiclePose other = vehicle;
        if (i < 3) other.position[i] += step;
        if (i == vehicle_parameter::kHeading) other.heading += step;
        if (i == vehicle_parameter::kPitch) other.pitch += step;
        if (i == vehicle_parameter::kRoll) other.roll += step;
        return observe_stance(line, other).height_pitch_roll;
      };
      const Vector3d slope = (stepped(kStep) - stepped(-kStep)) / (2 * kStep);
      CAPTURE(i);
      // The floor's direction turns in a bend; the prior does not follow that.
      CHECK((seen.by_vehicle.col(i) - slope).norm() < 0.02);
    }
  }
}
