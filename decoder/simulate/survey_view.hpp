// SPDX-License-Identifier: Apache-2.0
// The measurements of a rig's cameras and range sensors at a place of a surveyed tunnel.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "decoder/simulate/light.hpp"
#include "decoder/simulate/render_view.hpp"
#include "decoder/simulate/scene.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// ---- The tunnel itself as a camera sees it: walls, floor and roof, without plates.

// Brick walls that stand `standoff` metres behind the plates' planes (wall_standoff), a rough floor
// and roof that follow the center line's grade; one ray a pixel, textures softened to the pixel's
// size. Sees 60 m along the tunnel; beyond is darkness.
Backdrop tunnel_backdrop(const Tunnel& tunnel, double standoff, const Camera& camera,
                         const Pose& world_from_camera, const Lighting& lighting,
                         std::uint64_t seed);

// ---- Views and measurements.

// The plates that the camera's image could show if there were no walls, and their indices in
// survey.tags. World frame.
struct TagsInSight {
  std::vector<ScenePlate> plates;
  std::vector<std::size_t> tags;
};

TagsInSight tags_in_sight(const Survey& survey, const Camera& camera,
                          const Pose& world_from_camera);

// A camera's sight of the surveyed tags. `tags[i]` is the index in survey.tags of `view.plates[i]`;
// only tags of which something shows.
struct SurveyView {
  View view;
  std::vector<std::size_t> tags;
};

// Renders what the camera sees from this vehicle pose (world frame). The exposure follows the
// scene, as a camera's automatic does: the brightest plate's white gets 0.8 of full light, without
// a plate the walls' mean gets 0.18; options.sensor.exposure multiplies it. `tunnel_seed` makes the
// walls' texture: the same for all pictures of one tunnel.
SurveyView render_survey_view(const Survey& survey, const RigCamera& camera,
                              const Pose& world_from_vehicle, const ViewOptions& options,
                              std::uint64_t tunnel_seed);

// The light of a mine vehicle's headlamps in an otherwise dim tunnel.
Lighting tunnel_lighting();

// world_from_vehicle of a vehicle that stands as the floor below it is inclined: position in the
// grid; heading (grid, radians) or, without one, the tunnel's at that place.
Pose vehicle_in_tunnel(const Survey& survey, const Eigen::Vector3d& position_in_grid,
                       std::optional<double> heading_in_grid);

// The least horizontal distance from the vehicle's origin to the plates' surface of a wall.
double distance_to_wall(const Survey& survey, Side wall, const Eigen::Vector3d& position_in_world);

// That distance with the sensor's noise; nothing out of the sensor's range.
std::optional<double> measured_range(const Survey& survey, const RigRange& range,
                                     const Eigen::Vector3d& position_in_world, std::uint64_t seed);

}  // namespace tagsmith::detail
