// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/survey_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "decoder/simulate/noise.hpp"
#include "decoder/simulate/plate_in_image.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"
#include "tagsmith/placement/tunnel_surfaces.hpp"

namespace tagsmith::detail {

// ---- The tunnel without plates.

namespace {

using Eigen::Vector3d;

constexpr double kFar = 1e6;  // metres of depth where there is nothing

struct Place {
  double depth = kFar;
  double u = 0;  // metres on the surface
  double v = 0;
  double cosine = 1;  // between the ray and the surface's normal
  enum class Kind { nothing, left, right, floor, roof } kind = Kind::nothing;
  static constexpr std::uint64_t kKinds = 5;
};

// Fractal value noise about 0.
class Roughness {
 public:
  explicit Roughness(std::uint64_t seed) {
    for (ValueNoise& noise : noises_) noise = ValueNoise(++seed);
  }

  // An octave finer than the pixel's footprint is left out, because it would only flicker.
  double at(double u, double v, double footprint) {
    double sum = 0;
    for (std::size_t i = 0; i < kOctaves.size(); ++i) {
      const Octave& octave = kOctaves[i];
      const double fade = std::min(octave.wavelength / footprint / 2 - 0.5, 1.0);
      if (fade <= 0) break;
      const double noise = noises_[i].at(u / octave.wavelength, v / octave.wavelength);
      sum += fade * octave.amplitude * (2 * noise - 1);
    }
    return sum;
  }

 private:
  struct Octave {
    double wavelength;
    double amplitude;
  };
  static constexpr std::array<Octave, 5> kOctaves{
      {{1.3, 0.35}, {0.45, 0.30}, {0.16, 0.25}, {0.055, 0.2}, {0.02, 0.15}}};

  std::array<ValueNoise, kOctaves.size()> noises_;
};

// Share of mortar at a place of the wall, softened over the footprint.
double mortar(double u, double v, double footprint) {
  constexpr double kLength = 0.52;
  constexpr double kCourse = 0.18;
  constexpr double kJoint = 0.018;
  const double course = std::floor(v / kCourse);
  const double shifted = u / kLength + 0.5 * (course - 2 * std::floor(course / 2));
  const double to_side = kLength * std::abs(shifted - std::round(shifted));
  const double to_course = kCourse * std::abs(v / kCourse - std::round(v / kCourse));
  const double to_joint = std::min(to_side, to_course);
  const double soft = std::max(footprint, 1e-3);
  const double share = std::clamp((kJoint / 2 - to_joint) / soft + 0.5, 0.0, 1.0);
  return share * std::min(1.0, kJoint / soft);
}

// What the surfaces of a tunnel reflect.
class Surfaces {
 public:
  explicit Surfaces(std::uint64_t seed) {
    for (std::uint64_t kind = 0; kind < Place::kKinds; ++kind)
      rough_.emplace_back(seed + 100 * kind);
  }

  double reflectance(const Place& place, double footprint);

 private:
  std::vector<Roughness> rough_;  // by the kind of the place
};

double Surfaces::reflectance(const Place& place, double footprint) {
  const double rough = rough_[static_cast<std::size_t>(place.kind)].at(place.u, place.v, footprint);
  if (place.kind == Place::Kind::floor) return 0.16 * (1 + 0.8 * rough);
  if (place.kind == Place::Kind::roof) return 0.22 * (1 + 0.8 * rough);
  const double brick = 0.22 * (1 + 0.7 * rough);
  return brick + mortar(place.u, place.v, footprint) * (0.40 * (1 + 0.3 * rough) - brick);
}

bool is_level(const Tunnel& tunnel) {
  const auto& elements = tunnel.centerline.elements();
  return tunnel.height.is_constant() &&
         std::ranges::all_of(elements,
                             [](const CenterlineElement& element) { return element.grade == 0; });
}

// Heights of a point above the floor and above the roof.
class Height {
 public:
  explicit Height(const Tunnel& tunnel) : tunnel_(tunnel) {
    if (is_level(tunnel)) level_ = at(0);
  }

  double above_floor(const Vector3d& point) const { return point.z() - below(point).floor; }
  double above_roof(const Vector3d& point) const {
    const Levels levels = below(point);
    return point.z() - levels.floor - levels.roof_above_floor;
  }

 private:
  struct Levels {
    double floor = 0;
    double roof_above_floor = 0;
  };
  Levels at(double chainage) const {
    return {tunnel_.centerline.at(chainage).position.z(), tunnel_.height.at(chainage)};
  }
  Levels below(const Vector3d& point) const {
    return level_ ? *level_ : at(tunnel_.centerline.locate(point.head<2>()).chainage);
  }

  const Tunnel& tunnel_;
  std::optional<Levels> level_{};  // floor and roof at one z everywhere
};

// The way to where `height` passes 0, between `low` and `high`, where it lies on different sides:
// regula falsi (Illinois). The height is all but linear along a ray.
double way_to_height(const auto& height, const Vector3d& origin, const Vector3d& ray, double low,
                     double high) {
  double low_value = height(origin + low * ray);
  double high_value = height(origin + high * ray);
  for (int i = 0; i < 12 && std::abs(high - low) > 1e-4; ++i) {
    const double middle = (low * high_value - high * low_value) / (high_value - low_value);
    const double value = height(origin + middle * ray);
    if (std::abs(value) < 1e-4) return middle;
    if ((value > 0) == (high_value > 0)) {
      high = middle;
      high_value = value;
      low_value *= 0.5;
    } else {
      low = middle;
      low_value = value;
      high_value *= 0.5;
    }
  }
  return high;
}

// A ray meets the floor or the roof within this part of its way.
struct Meeting {
  double low = 0;
  double high = 0;
  bool down = false;
};

// On the way to a wall: where the grade changes, or at the latest where the wall is.
std::optional<Meeting> meeting(const FloorAndRoof& floor_and_roof, const Height& height,
                               const Vector3d& origin, const Vector3d& ray, double way) {
  if (const auto exit = floor_and_roof.first_exit(origin, ray, way)) {
    return Meeting{exit->last_inside, exit->first_outside, exit->through_floor};
  }
  const Vector3d at_wall = origin + way * ray;
  const bool down = height.above_floor(at_wall) < 0;
  if (!down && height.above_roof(at_wall) <= 0) return std::nullopt;
  return Meeting{0, way, down};
}

Place look(const TunnelWalls& walls, const FloorAndRoof& floor_and_roof, const Height& height,
           const Vector3d& origin, const Vector3d& ray) {
  Place place;
  const std::optional<WallHit> wall = walls.first_hit(origin.head<2>(), ray.head<2>());
  const double way = wall ? wall->way : kFar;
  if (const auto found = meeting(floor_and_roof, height, origin, ray, way)) {
    place.kind = found->down ? Place::Kind::floor : Place::Kind::roof;
    const auto above = [&](const Vector3d& point) {
      return found->down ? height.above_floor(point) : height.above_roof(point);
    };
    place.depth = way_to_height(above, origin, ray, found->low, found->high);
    const Vector3d point = origin + place.depth * ray;
    place.u = point.x();
    place.v = point.y();
    place.cosine = std::abs(ray.z()) / ray.norm();
  } else if (wall) {
    place.kind = wall->side == Side::left ? Place::Kind::left : Place::Kind::right;
    place.depth = way;
    place.u = wall->chainage;
    place.v = height.above_floor(origin + way * ray);
    place.cosine = wall->cosine * ray.head<2>().norm() / ray.norm();
  }
  return place;
}

}  // namespace

Backdrop tunnel_backdrop(const Tunnel& tunnel, double standoff, const Camera& camera,
                         const Pose& world_from_camera, const Lighting& lighting,
                         std::uint64_t seed) {
  const Vector3d origin = world_from_camera.translation;
  const double chainage = tunnel.centerline.locate(origin.head<2>()).chainage;
  const TunnelWalls walls(tunnel, standoff, chainage);
  const FloorAndRoof floor_and_roof(tunnel, chainage);
  const Height height(tunnel);
  Surfaces surfaces(seed);
  Backdrop backdrop{LightImage(camera.width, camera.height),
                    LightImage(camera.width, camera.height, static_cast<float>(kFar))};
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto ray_in_camera =
          ray_through(camera, {static_cast<double>(x), static_cast<double>(y)});
      if (!ray_in_camera) continue;
      const Vector3d ray = world_from_camera.rotation * *ray_in_camera;
      const Place place = look(walls, floor_and_roof, height, origin, ray);
      if (place.kind == Place::Kind::nothing) continue;
      const double distance = place.depth * ray.norm();
      const double footprint = distance / camera.fx / std::sqrt(std::max(place.cosine, 0.01));
      const double light =
          irradiance(lighting, distance, place.cosine) * surfaces.reflectance(place, footprint);
      backdrop.light.row(y)[x] = static_cast<float>(std::max(light, 0.0));
      backdrop.depth.row(y)[x] = static_cast<float>(place.depth);
    }
  }
  return backdrop;
}

// ---- What is seen and measured.

namespace {

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
