// SPDX-License-Identifier: Apache-2.0
// Exact observations of shipped surveys.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>
#include <doctest/doctest.h>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/rig.hpp"

namespace tagsmith::detail::test {

struct Site {
  Survey survey;
  Rig rig;
};

inline Site site_named(const std::string& name) {
  const auto survey = load_survey("surveys/" + name + "/survey.yaml");
  REQUIRE(survey.has_value());
  const auto rig = load_rig("surveys/" + name + "/rig.yaml");
  REQUIRE(rig.has_value());
  return {*survey, *rig};
}

// What all cameras see of the tags, exactly, stated to a fiftieth of a pixel.
inline Observation observation_at(const Site& site, const VehiclePose& vehicle) {
  const VehicleFrame frame = vehicle_frame(vehicle);
  const double length = site.survey.tag_template.frame_inner_length;
  const double height = site.survey.tag_template.frame_inner_height;
  const Eigen::Vector3d in_plate[] = {
      {0, 0, 0}, {length, 0, 0}, {length, height, 0}, {0, height, 0}};
  Observation observation;
  for (const RigCamera& camera : site.rig.cameras) {
    for (const PlacedTag& tag : site.survey.tags) {
      SeenCorners seen;
      seen.covariance *= 0.02 * 0.02;
      const Eigen::Vector3d from_o = tag.world_from_plate.translation - vehicle.position;
      bool visible = from_o.dot(tag.world_from_plate.rotation.col(2)) > 0.3;  // its front
      for (std::size_t i = 0; i < 4; ++i) {
        const auto point = observe_point(camera.camera, camera.vehicle_from_camera, frame,
                                         tag.world_from_plate, in_plate[i]);
        visible = visible && point && in_image(camera.camera, point->pixel);
        if (visible) seen.corners[i] = {point->pixel.x(), point->pixel.y()};
      }
      if (visible) observation.tags.push_back({camera.name, 0, tag, seen, std::nullopt});
    }
  }
  return observation;
}

inline VehiclePose pose_at(const Site& site, double chainage, double offset) {
  const CenterlinePoint at = site.survey.tunnel.centerline.at(chainage);
  VehiclePose pose;
  pose.position = at.position + offset * right_of(at.heading) +
                  Eigen::Vector3d(0, 0, site.rig.vehicle_height + 0.01);
  pose.heading = at.heading + radians(4);
  pose.pitch = radians(1.5);
  pose.roll = radians(-1);
  return pose;
}

inline double error_of(const Fix& fix, const Site& site, const VehiclePose& truth) {
  REQUIRE_MESSAGE(fix.position_in_grid.has_value(), fix.reason);
  return (*fix.position_in_grid - grid_from_world(site.survey.grid, truth.position)).norm();
}

}  // namespace tagsmith::detail::test
