// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/survey_view.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "decoder/simulate/noise.hpp"
#include "decoder/simulate/plate_in_image.hpp"
#include "decoder/simulate/tunnel_backdrop.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"
#include "tagsmith/placement/tunnel_surfaces.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Vector3d;

constexpr double kSight = 40;  // metres; a module of the larger template is 0.25 px there

TagsInSight only_visible(TagsInSight sight, const std::vector<PlateTruth>& truths) {
  TagsInSight visible;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    if (truths[i].visible_fraction <= 0) continue;
    visible.plates.push_back(std::move(sight.plates[i]));
    visible.tags.push_back(sight.tags[i]);
  }
  return visible;
}

double white_light(const Lighting& lighting, const ScenePlate& plate) {
  const Vector3d middle = frame_middle_in_camera(plate);
  const double cosine = plate.camera_from_plate.rotation.col(2).dot(middle.normalized());
  return irradiance(lighting, middle.norm(), cosine) * plate.finish.white_reflectance;
}

double automatic_exposure(const Lighting& lighting, const std::vector<ScenePlate>& plates,
                          const Backdrop& backdrop) {
  constexpr double kPlateShare = 0.8;
  constexpr double kWallShare = 0.18;  // the grey card's
  double brightest = 0;
  for (const ScenePlate& plate : plates) {
    brightest = std::max(brightest, white_light(lighting, plate));
  }
  if (brightest > 0) return kPlateShare / brightest;
  const std::vector<float>& samples = backdrop.light.samples;
  const double mean =
      std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
  return mean > 0 ? kWallShare / mean : 1.0;
}

std::string metres(double value) { return format_number(value, 3) + " m"; }

}  // namespace

TagsInSight tags_in_sight(const Survey& survey, const Camera& camera,
                          const Pose& world_from_camera) {
  const Pose camera_from_world = inverse(world_from_camera);
  const ViewingFrustum frustum = viewing_frustum(camera, 1);
  TagsInSight sight;
  for (std::size_t i = 0; i < survey.tags.size(); ++i) {
    const PlacedTag& tag = survey.tags[i];
    const Pose camera_from_plate = camera_from_world * tag.world_from_plate;
    if (camera_from_plate.translation.norm() > kSight) continue;
    ScenePlate plate{draw_tag(survey.tag_template, tag.digits), camera_from_plate, {}};
    if (!faces_camera(plate)) continue;
    if (outline_in_image(camera, frustum, camera_from_plate, plate.drawing.plate).empty()) continue;
    sight.plates.push_back(std::move(plate));
    sight.tags.push_back(i);
  }
  return sight;
}

Lighting tunnel_lighting() { return {0.35, 1.0, 0.8}; }

SurveyView render_survey_view(const Survey& survey, const RigCamera& camera,
                              const Pose& world_from_vehicle, const ViewOptions& options,
                              std::uint64_t tunnel_seed) {
  const Pose world_from_camera = world_from_vehicle * camera.vehicle_from_camera;
  const double chainage =
      survey.tunnel.centerline.locate(world_from_camera.translation.head<2>()).chainage;
  const Backdrop backdrop =
      tunnel_backdrop(survey.tunnel, wall_standoff(survey, chainage), camera.camera,
                      world_from_camera, options.lighting, tunnel_seed);
  TagsInSight sight = tags_in_sight(survey, camera.camera, world_from_camera);
  const std::vector<PlateTruth> truths = plate_truths(camera.camera, sight.plates, &backdrop);
  sight = only_visible(std::move(sight), truths);
  ViewOptions exposed = options;
  exposed.sensor.exposure *= automatic_exposure(options.lighting, sight.plates, backdrop);
  return {render_view(camera.camera, sight.plates, exposed, &backdrop), std::move(sight.tags)};
}

Result<void> check_in_tunnel(const Survey& survey, const Vector3d& position_in_world) {
  const Tunnel& tunnel = survey.tunnel;
  const CenterlineAddress address = tunnel.centerline.locate(position_in_world.head<2>());
  const Side side = address.offset < 0 ? Side::left : Side::right;
  if (behind_wall(tunnel, side, address) >= 0) {
    return fail(metres(std::abs(address.offset)) + " " + to_string(side) +
                " of the center line, expected less than the distance of that wall's plates, " +
                metres(wall_distance(tunnel, side, address.chainage)));
  }
  const double above_floor =
      position_in_world.z() - tunnel.centerline.at(address.chainage).position.z();
  const double height = tunnel.height.at(address.chainage);
  if (above_floor <= 0 || above_floor >= height) {
    return fail(metres(above_floor) +
                " above the floor, expected between 0 and the tunnel's height, " + metres(height));
  }
  return {};
}

Pose vehicle_in_tunnel(const Survey& survey, const Vector3d& position_in_grid,
                       std::optional<double> heading_in_grid) {
  const Centerline& line = survey.tunnel.centerline;
  const Vector3d position = world_from_grid(survey.grid, position_in_grid);
  const CenterlinePoint floor = line.at(line.locate(position.head<2>()).chainage);
  FloorStance stance;
  if (heading_in_grid) {
    stance.yaw = world_heading_from_grid(survey.grid, *heading_in_grid) - floor.heading;
  }
  VehiclePose vehicle = vehicle_on_floor(floor, stance);
  vehicle.position = position;
  return world_from_vehicle(vehicle);
}

double distance_to_wall(const Survey& survey, Side wall, const Vector3d& position_in_world) {
  return observe_wall(survey.tunnel.centerline, wall_of(survey.tunnel, wall), position_in_world)
      .distance;
}

std::optional<double> measured_range(const Survey& survey, const RigRange& range,
                                     const Vector3d& position_in_world, std::uint64_t seed) {
  const double distance = distance_to_wall(survey, range.wall, position_in_world);
  const double measured = distance + range.sigma * gaussian_noise(seed, 0);
  if (measured < range.min || measured > range.max) return std::nullopt;
  return measured;
}

}  // namespace tagsmith::detail
