// SPDX-License-Identifier: Apache-2.0
// What a vehicle sees of a shipped survey on its way along the drive.
#pragma once

#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"
#include "tests/localize/site.hpp"
#include "tests/support/draws.hpp"

namespace tagsmith::detail::test {

inline constexpr double kNoise = 0.05;  // pixels

// Vehicles along the drive that stand a little askew, but not on their mean.
// `is_level`: their attitudes have a mean of zero, as their axes are defined; else they are drawn.
inline std::vector<VehiclePose> drive_past(const Site& site, std::size_t count, Draws& draws,
                                           bool is_level = true, bool is_backward = false) {
  std::vector<FloorStance> stances(count);
  FloorStance mean;
  for (FloorStance& stance : stances) {
    stance.height = site.rig.vehicle_height;
    stance.lateral = draws.uniform(-0.3, 0.3);
    stance.yaw = draws.normal(radians(2));
    stance.pitch = draws.normal(radians(1));
    stance.roll = draws.normal(radians(1));
    mean.yaw += stance.yaw / static_cast<double>(count);
    mean.pitch += stance.pitch / static_cast<double>(count);
    mean.roll += stance.roll / static_cast<double>(count);
  }
  std::vector<VehiclePose> vehicles;
  for (std::size_t i = 0; i < count; ++i) {
    FloorStance stance = stances[i];
    if (is_level) {
      stance.yaw -= mean.yaw;
      stance.pitch -= mean.pitch;
      stance.roll -= mean.roll;
    }
    if (is_backward) stance.yaw += std::numbers::pi;
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    vehicles.push_back(
        vehicle_on_floor(site.survey.tunnel.centerline.at(-0.5 + 5.5 * share), stance));
  }
  return vehicles;
}

inline std::vector<Observation> seen_from(const Site& site,
                                          const std::vector<VehiclePose>& vehicles, Draws& draws) {
  std::vector<Observation> rows;
  for (const VehiclePose& vehicle : vehicles) {
    rows.push_back(observation_at(site, vehicle));
    rows.back().id = std::to_string(rows.size());
    for (SeenTag& tag : rows.back().tags) {
      for (auto& corner : tag.seen_corners->corners) {
        corner.x += draws.normal(kNoise);
        corner.y += draws.normal(kNoise);
      }
      tag.seen_corners->covariance = kNoise * kNoise * CornerCovariance::Identity();
    }
  }
  return rows;
}

inline void mount(Rig& rig, std::size_t camera, double yaw, double pitch, double roll,
                  const Eigen::Vector3d& position) {
  rig.cameras[camera].vehicle_from_camera =
      vehicle_from_camera(radians(yaw), radians(pitch), radians(roll), position);
}

inline Site exact_corridor() {
  Site site = site_named("corridor");
  site.survey.sigma = 0;
  for (PlacedTag& tag : site.survey.tags) tag.sigma = 0;
  return site;
}

}  // namespace tagsmith::detail::test
