// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/observation_model.hpp"

#include <functional>
#include <random>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

using namespace tagsmith::detail;
using Eigen::Vector3d;

namespace {

// What an observed point depends on, with every disturbance that it has a derivative for.
struct Setup {
  Camera camera = camera_from_sensor(1280, 960, 6.0, 4.8, 3.6);
  Pose vehicle_from_camera;
  VehiclePose vehicle;
  Pose world_from_plate;
  Vector3d point_in_plate = Vector3d::Zero();
};

using Random = std::function<double()>;  // in [-1, 1]

Vector3d random_vector(const Random& unit) { return {unit(), unit(), unit()}; }

Eigen::Matrix3d small_turn(int axis, double angle) {
  return Eigen::AngleAxisd(angle, Vector3d::Unit(axis)).toRotationMatrix();
}

// A camera, anyhow mounted and distorted, that has the plate in sight.
Setup random_setup(const Random& unit) {
  Setup setup;
  setup.camera.fy *= 1 + 0.05 * unit();
  setup.camera.cx += 20 * unit();
  setup.camera.distortion[0] = 0.2 * unit();
  setup.camera.distortion[1] = 0.05 * unit();
  setup.camera.distortion[2] = 0.005 * unit();
  setup.camera.distortion[3] = 0.005 * unit();
  setup.camera.distortion[4] = 0.01 * unit();
  setup.vehicle_from_camera = {rotation_from_yaw_pitch_roll(3 * unit(), unit(), 3 * unit()),
                               random_vector(unit)};
  setup.vehicle = {10 * random_vector(unit), 3 * unit(), 0.3 * unit(), 0.3 * unit()};
  const Pose camera_from_plate{rotation_from_yaw_pitch_roll(unit(), 0.7 * unit(), 0.7 * unit()),
                               {0.5 * unit(), 0.4 * unit(), 2 + 0.5 * unit()}};
  setup.world_from_plate =
      world_from_vehicle(setup.vehicle) * setup.vehicle_from_camera * camera_from_plate;
  setup.point_in_plate = {0.3 * unit(), 0.2 * unit(), 0};
  return setup;
}

ObservedPoint observe(const Setup& setup) {
  const auto observed =
      observe_point(setup.camera, setup.vehicle_from_camera, vehicle_frame(setup.vehicle),
                    setup.world_from_plate, setup.point_in_plate);
  REQUIRE(observed.has_value());
  return *observed;
}

// The pixel's change by a disturbance of size h, both ways.
template <typename Disturb>
Eigen::Vector2d numeric(const Setup& setup, const Disturb& disturb) {
  constexpr double kStep = 1e-6;
  Setup plus = setup;
  Setup minus = setup;
  disturb(plus, kStep);
  disturb(minus, -kStep);
  return (observe(plus).pixel - observe(minus).pixel) / (2 * kStep);
}

void check_equal(const Eigen::Vector2d& analytic, const Eigen::Vector2d& numeric) {
  CHECK((analytic - numeric).norm() < 1e-4 * (1 + numeric.norm()));
}

}  // namespace

TEST_CASE("the pixel of a plate's point is that of the chain of poses") {
  constexpr unsigned kSeed = 31;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Random unit = [&] { return uniform(random); };
  for (int i = 0; i < 100; ++i) {
    const Setup setup = random_setup(unit);
    const Pose camera_from_plate =
        inverse(world_from_vehicle(setup.vehicle) * setup.vehicle_from_camera) *
        setup.world_from_plate;
    const auto pixel = project(setup.camera, camera_from_plate * setup.point_in_plate);
    REQUIRE(pixel.has_value());
    CHECK((observe(setup).pixel - *pixel).norm() < 1e-8);
  }
}

TEST_CASE("the derivatives of a pixel are those that differences show") {
  constexpr unsigned kSeed = 32;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Random unit = [&] { return uniform(random); };
  for (int i = 0; i < 50; ++i) {
    CAPTURE(i);
    const Setup setup = random_setup(unit);
    const ObservedPoint at = observe(setup);
    for (int axis = 0; axis < 3; ++axis) {
      CAPTURE(axis);
      check_equal(at.by_vehicle.col(axis),
                  numeric(setup, [&](Setup& s, double h) { s.vehicle.position[axis] += h; }));
      check_equal(at.by_plate.col(axis), numeric(setup, [&](Setup& s, double h) {
                    s.world_from_plate.translation[axis] += h;
                  }));
      check_equal(at.by_plate.col(3 + axis), numeric(setup, [&](Setup& s, double h) {
                    s.world_from_plate.rotation *= small_turn(axis, h);
                  }));
      check_equal(at.by_mounting.col(axis), numeric(setup, [&](Setup& s, double h) {
                    s.vehicle_from_camera.translation[axis] += h;
                  }));
      check_equal(at.by_mounting.col(3 + axis), numeric(setup, [&](Setup& s, double h) {
                    s.vehicle_from_camera.rotation *= small_turn(axis, h);
                  }));
    }
    using namespace vehicle_parameter;
    check_equal(at.by_vehicle.col(kHeading),
                numeric(setup, [](Setup& s, double h) { s.vehicle.heading += h; }));
    check_equal(at.by_vehicle.col(kPitch),
                numeric(setup, [](Setup& s, double h) { s.vehicle.pitch += h; }));
    check_equal(at.by_vehicle.col(kRoll),
                numeric(setup, [](Setup& s, double h) { s.vehicle.roll += h; }));
    check_equal(at.by_intrinsics.col(0), numeric(setup, [](Setup& s, double h) {
                  s.camera.fx *= 1 + h;
                  s.camera.fy *= 1 + h;
                }));
    check_equal(at.by_intrinsics.col(1),
                numeric(setup, [](Setup& s, double h) { s.camera.cx += h; }));
    check_equal(at.by_intrinsics.col(2),
                numeric(setup, [](Setup& s, double h) { s.camera.cy += h; }));
    check_equal(at.by_intrinsics.col(3),
                numeric(setup, [](Setup& s, double h) { s.camera.distortion[0] += h; }));
  }
}

TEST_CASE("a point behind the camera is not observed") {
  Setup setup;
  setup.point_in_plate = {0, 0, -1};
  CHECK_FALSE(observe_point(setup.camera, setup.vehicle_from_camera, vehicle_frame(setup.vehicle),
                            setup.world_from_plate, setup.point_in_plate)
                  .has_value());
}

TEST_CASE("corners move so that each side lies a pixel further out") {
  Eigen::Matrix<double, 8, 1> corners;
  corners << 100, 50, 190, 80, 170, 160, 90, 140;
  const Eigen::Matrix<double, 8, 1> shift = by_outward_edges(corners);
  for (Eigen::Index i = 0; i < 4; ++i) {
    CAPTURE(i);
    const Eigen::Index next = (i + 1) % 4;
    const Eigen::Vector2d side = corners.segment<2>(2 * next) - corners.segment<2>(2 * i);
    const Eigen::Vector2d outward = Eigen::Vector2d(side.y(), -side.x()).normalized();
    CHECK(outward.dot(shift.segment<2>(2 * i)) == doctest::Approx(1));
    CHECK(outward.dot(shift.segment<2>(2 * next)) == doctest::Approx(1));
  }
}

TEST_CASE("a vehicle's pose goes to its frame and back") {
  const VehiclePose vehicle{{1, -2, 3}, 2.5, -0.2, 0.4};
  const VehiclePose again = vehicle_pose_of(world_from_vehicle(vehicle));
  CHECK((again.position - vehicle.position).norm() == 0);
  CHECK(again.heading == doctest::Approx(2.5));
  CHECK(again.pitch == doctest::Approx(-0.2));
  CHECK(again.roll == doctest::Approx(0.4));
  // Heading is from +y towards +x; pitch positive nose down.
  const Pose ahead = world_from_vehicle(VehiclePose{{0, 0, 0}, 0, 0.1, 0});
  CHECK(ahead.rotation(1, 0) == doctest::Approx(std::cos(0.1)));
  CHECK(ahead.rotation(2, 0) == doctest::Approx(-std::sin(0.1)));
}

TEST_CASE(
    "the distance to a wall and its derivative, on a line, in either bend and beyond the end") {
  const Centerline line({2, 1, 0}, 0.4,
                        {{3.0, 0, 0.02}, {6.0, 1 / 8.0, 0}, {4.0, -1 / 5.0, -0.05}, {2.0, 0, 0}});
  constexpr double kHalf = 1.9;
  for (double chainage = -1.05; chainage < 16; chainage += 0.5) {
    CAPTURE(chainage);
    const CenterlinePoint at = line.at(chainage);
    const Vector3d o = at.position + 0.3 * right_of(at.heading) + Vector3d(0, 0, 0.5);
    const ObservedWall left = observe_wall(line, -kHalf, o);
    const ObservedWall right = observe_wall(line, kHalf, o);
    CHECK(left.distance == doctest::Approx(kHalf + 0.3));
    CHECK(right.distance == doctest::Approx(kHalf - 0.3));
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = 1e-6 * Vector3d::Unit(axis);
      const auto slope = [&](double wall) {
        return (observe_wall(line, wall, o + step).distance -
                observe_wall(line, wall, o - step).distance) /
               2e-6;
      };
      CHECK(left.by_position[axis] == doctest::Approx(slope(-kHalf)).epsilon(1e-5));
      CHECK(right.by_position[axis] == doctest::Approx(slope(kHalf)).epsilon(1e-5));
    }
  }
  CHECK(observe_wall(line, -kHalf, line.at(1).position - 2 * right_of(0.4)).distance ==
        doctest::Approx(-0.1));
}
