// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/mounting.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tests/calibrate/seen_drive.hpp"

using namespace tagsmith::detail;
using Eigen::Vector3d;
using tagsmith::detail::test::Draws;
using tagsmith::detail::test::drive_past;
using tagsmith::detail::test::exact_corridor;
using tagsmith::detail::test::mount;
using tagsmith::detail::test::seen_from;
using tagsmith::detail::test::Site;

namespace {

double angle_between(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.rotation.transpose() * b.rotation).angle();
}

}  // namespace

TEST_CASE("unknown angles are found to hundredths of a degree, wherever the search starts") {
  for (const double stated_alpha : {35.0, 40.0, 10.0, -40.0}) {
    CAPTURE(stated_alpha);
    Draws draws(7);
    Site site = exact_corridor();
    mount(site.rig, 0, 52, 3, -2, Vector3d::Zero());
    mount(site.rig, 1, -58, -1, 4, Vector3d::Zero());
    const auto rows = seen_from(site, drive_past(site, 12, draws), draws);
    Rig stated = site.rig;
    mount(stated, 0, 90 - stated_alpha, 0, 0, Vector3d::Zero());
    mount(stated, 1, stated_alpha - 90, 0, 0, Vector3d::Zero());
    const auto fit = fit_mounting(rows, site.survey, stated);
    REQUIRE_MESSAGE(fit.has_value(), fit.error().message);
    for (std::size_t c = 0; c < 2; ++c) {
      const Pose& truth = site.rig.cameras[c].vehicle_from_camera;
      CHECK(angle_between(fit->cameras[c].vehicle_from_camera, truth) < radians(0.03));
      // The mean of twelve rows that scatter by 2 degrees is no better known.
      CHECK(fit->cameras[c].sigma.tail<3>().maxCoeff() < radians(0.9));
      CHECK(fit->cameras[c].left_out == 0);
      CHECK_FALSE(fit->cameras[c].held[3]);
    }
  }
}

TEST_CASE("how far cameras are apart is told, where they are on the vehicle is held") {
  Draws draws(11);
  Site site = exact_corridor();
  mount(site.rig, 0, 55, 0, 0, {0.40, 0.25, 0.10});
  mount(site.rig, 1, -55, 0, 0, {0.10, -0.25, 0.05});
  const auto rows = seen_from(site, drive_past(site, 20, draws), draws);
  Rig stated = site.rig;
  stated.cameras[0].vehicle_from_camera.translation = {0.30, 0.2, 0.15};
  stated.cameras[1].vehicle_from_camera.translation = {0.10, -0.2, 0.05};
  const auto fit = fit_mounting(rows, site.survey, stated);
  REQUIRE_MESSAGE(fit.has_value(), fit.error().message);
  // Only where it is told how high O is, heights are.
  Rig known_height = stated;
  known_height.height_sigma = 0.002;
  const auto with_height = fit_mounting(rows, site.survey, known_height);
  REQUIRE(with_height.has_value());
  CHECK_FALSE(with_height->cameras[0].held[2]);
  CHECK_FALSE(with_height->cameras[1].held[2]);
  CHECK(std::abs(with_height->cameras[0].vehicle_from_camera.translation.z() - 0.10) < 0.004);
  const Vector3d apart = fit->cameras[0].vehicle_from_camera.translation -
                         fit->cameras[1].vehicle_from_camera.translation;
  CHECK((apart - Vector3d(0.30, 0.50, 0.05)).norm() < 0.002);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    CHECK(fit->cameras[0].held[axis] != fit->cameras[1].held[axis]);
  }
}

TEST_CASE("a plate that hangs elsewhere is left out and bends nothing") {
  Draws draws(13);
  Site site = exact_corridor();
  const Survey surveyed = site.survey;
  site.survey.tags[4].world_from_plate.translation += Vector3d(0.05, 0.12, 0.03);
  auto rows = seen_from(site, drive_past(site, 20, draws), draws);
  for (Observation& row : rows) {
    for (SeenTag& tag : row.tags) tag.tag = *find_tag(surveyed, tag.tag.name);
  }
  Rig stated = site.rig;
  mount(stated, 0, 50, 2, 0, Vector3d::Zero());
  const auto fit = fit_mounting(rows, surveyed, stated);
  REQUIRE_MESSAGE(fit.has_value(), fit.error().message);
  // The rows that are left stand askew by a little on their mean: what holds is the angle between
  // the cameras.
  const auto between = [](const Pose& left, const Pose& right) { return inverse(left) * right; };
  CHECK(angle_between(
            between(fit->cameras[0].vehicle_from_camera, fit->cameras[1].vehicle_from_camera),
            between(site.rig.cameras[0].vehicle_from_camera,
                    site.rig.cameras[1].vehicle_from_camera)) < radians(0.03));
  CHECK(fit->cameras[0].left_out + fit->cameras[1].left_out > 0);
}

TEST_CASE("the stated sigmas are those of the errors") {
  Draws draws(17);
  double sum = 0;
  int count = 0;
  for (int trial = 0; trial < 25; ++trial) {
    Site site = exact_corridor();
    site.survey.sigma = 0.002;
    for (PlacedTag& tag : site.survey.tags) tag.sigma = 0.002;
    Site hung = site;
    for (PlacedTag& tag : hung.survey.tags) {
      tag.world_from_plate.translation += draws.normals(0.002);
    }
    auto rows = seen_from(hung, drive_past(hung, 10, draws, false), draws);
    for (Observation& row : rows) {
      for (SeenTag& tag : row.tags) tag.tag = *find_tag(site.survey, tag.tag.name);
    }
    const auto fit = fit_mounting(rows, site.survey, site.rig);
    REQUIRE_MESSAGE(fit.has_value(), fit.error().message);
    for (std::size_t c = 0; c < 2; ++c) {
      const MountingAngles found = mounting_angles(fit->cameras[c].vehicle_from_camera);
      const MountingAngles truth = mounting_angles(site.rig.cameras[c].vehicle_from_camera);
      const Vector3d off(found.yaw - truth.yaw, found.pitch - truth.pitch, found.roll - truth.roll);
      sum += off.cwiseQuotient(fit->cameras[c].sigma.tail<3>()).squaredNorm();
      count += 3;
    }
  }
  CHECK(sum / count > 0.6);
  CHECK(sum / count < 1.5);
}

TEST_CASE("rows that are close together show one stance of the vehicle, and the sigmas hold it") {
  Draws draws(19);
  Site site = exact_corridor();
  FloorStance askew;
  askew.height = site.rig.vehicle_height;
  askew.yaw = radians(2);
  askew.pitch = radians(-1.5);
  askew.roll = radians(1);
  std::vector<VehiclePose> vehicles;
  for (int i = 0; i < 20; ++i) {
    vehicles.push_back(vehicle_on_floor(site.survey.tunnel.centerline.at(2 + 0.05 * i), askew));
  }
  const auto fit = fit_mounting(seen_from(site, vehicles, draws), site.survey, site.rig);
  REQUIRE_MESSAGE(fit.has_value(), fit.error().message);
  CHECK(fit->rows == 20);
  CHECK(fit->places_apart == 3);
  for (std::size_t c = 0; c < 2; ++c) {
    const MountingAngles found = mounting_angles(fit->cameras[c].vehicle_from_camera);
    const MountingAngles truth = mounting_angles(site.rig.cameras[c].vehicle_from_camera);
    const Vector3d off(found.yaw - truth.yaw, found.pitch - truth.pitch, found.roll - truth.roll);
    CHECK(off.cwiseQuotient(fit->cameras[c].sigma.tail<3>()).cwiseAbs().maxCoeff() < 2);
    CHECK(off.norm() > radians(1));
  }
}

TEST_CASE("the place of one camera against another is as sure as the direction that is forward") {
  Draws draws(29);
  double sum = 0;
  constexpr int kTrials = 25;
  for (int trial = 0; trial < kTrials; ++trial) {
    Site site = exact_corridor();
    mount(site.rig, 0, 55, 0, 0, {0.3, 0.3, 0.1});
    mount(site.rig, 1, -55, 0, 0, {0.3, -0.3, 0.1});
    const auto rows = seen_from(site, drive_past(site, 12, draws, false), draws);
    const auto fit = fit_mounting(rows, site.survey, site.rig);
    REQUIRE_MESSAGE(fit.has_value(), fit.error().message);
    const double apart = fit->cameras[0].vehicle_from_camera.translation.x() -
                         fit->cameras[1].vehicle_from_camera.translation.x();
    sum += std::pow(apart / std::max(fit->cameras[0].sigma[0], fit->cameras[1].sigma[0]), 2);
  }
  CHECK(sum / kTrials > 0.4);
  CHECK(sum / kTrials < 1.6);
}

TEST_CASE("which way the vehicle went does not change its mounting") {
  for (const bool is_both : {true, false}) {
    CAPTURE(is_both);
    Draws draws(23);
    Site site = exact_corridor();
    mount(site.rig, 0, 55, 0, 0, {3.0, 0.2, 0.1});
    mount(site.rig, 1, -55, 0, 0, {3.0, -0.2, 0.1});
    auto rows = seen_from(site, drive_past(site, 12, draws, true, true), draws);
    if (is_both) {
      const auto ahead = seen_from(site, drive_past(site, 12, draws), draws);
      rows.insert(rows.end(), ahead.begin(), ahead.end());
    }
    Rig stated = site.rig;
    mount(stated, 0, 50, 2, 0, {3.0, 0.2, 0.1});
    const auto fit = fit_mounting(rows, site.survey, stated);
    REQUIRE_MESSAGE(fit.has_value(), fit.error().message);
    for (std::size_t c = 0; c < 2; ++c) {
      const Pose& truth = site.rig.cameras[c].vehicle_from_camera;
      // The rows that show tags stand askew by a little on their mean.
      CHECK(angle_between(fit->cameras[c].vehicle_from_camera, truth) < radians(1));
      CHECK(fit->cameras[c].left_out == 0);
    }
  }
}

TEST_CASE("a range that measures from elsewhere is told by its median") {
  Draws draws(19);
  const Site site = exact_corridor();
  const auto vehicles = drive_past(site, 15, draws);
  auto rows = seen_from(site, vehicles, draws);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double wall = observe_wall(site.survey.tunnel.centerline,
                                     wall_of(site.survey.tunnel, Side::left), vehicles[i].position)
                            .distance;
    rows[i].ranges["d"] = wall + 0.031 + draws.normal(0.01);
  }
  rows[3].ranges["d"] += 0.8;
  const auto fit = fit_mounting(rows, site.survey, site.rig);
  REQUIRE_MESSAGE(fit.has_value(), fit.error().message);
  REQUIRE(fit->ranges.size() == 1);
  CHECK(std::abs(fit->ranges[0].offset - 0.031) < 3 * fit->ranges[0].sigma);
  CHECK(fit->ranges[0].sigma < 0.006);
}

TEST_CASE("two rows tell no mounting") {
  Draws draws(23);
  const Site site = exact_corridor();
  const auto rows = seen_from(site, drive_past(site, 2, draws), draws);
  const auto fit = fit_mounting(rows, site.survey, site.rig);
  REQUIRE_FALSE(fit.has_value());
  CHECK(fit.error().message.find("2 of 2 rows") == 0);
}
