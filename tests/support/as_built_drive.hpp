// SPDX-License-Identifier: Apache-2.0
// A drive past plates that hang centimetres from where the survey has them, by drawn corners.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "decoder/verify/as_built.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/draws.hpp"

namespace tagsmith::detail::test {

struct AsBuiltDrive {
  Survey survey;
  Rig rig;                 // as its file states it
  std::vector<Pose> hung;  // where the tags truly hang, by the survey's tags
  std::vector<std::string> control;
  std::vector<SightedTag> sighted;
};

struct AsBuiltDriveOptions {
  int pairs = 50;
  int stations = 200;
  double control_every = 20;     // metres, and at the end: a control tag on either wall
  double control_sigma = 0.002;  // metres
  double displaced = 0.02;       // metres, of all others
  double turned = radians(0.3);  // of all
  double noise = 0.1;            // pixels
};

// Plates of 0.4 m, 0.8 m apart, on the walls of a straight drive 1.9 m wide.
inline Survey long_survey(const AsBuiltDriveOptions& options) {
  const std::string text = fmt::format(
      "survey: drive\n"
      "tunnel: {{ width: 1.9, height: 3.0, centerline: {{ start: [5, 0, 0], heading: 0,"
      " elements: [ {{ line: {} }} ] }} }}\n"
      "tags: {{ template: tag-400x300, height: 0.4, spacing: 0.4, first: 1, pairs: {},"
      " sigma: {}, angle_sigma: {} }}\n"
      "code: {{ check_digit: sum10, resolution: 0.01, digits: [3, 6, 2], origin: [0, 0, 0] }}\n",
      0.8 * options.pairs + 3, options.pairs, options.control_sigma, degrees(options.turned));
  const Diagnosed<Survey> reading = read_survey_text("surveys/corridor/drive.yaml", text);
  if (!reading.value) throw std::runtime_error(to_string(reading.diagnostics, true));
  return *reading.value;
}

// The corridor's rig, with wider lenses that are calibrated with some care.
inline Rig wide_rig() {
  Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  for (RigCamera& camera : rig.cameras) {
    camera.camera.fx = camera.camera.fy = 800;
    camera.calibration_sigma = {};
    camera.calibration_sigma.position = 0.002;
    camera.calibration_sigma.angle = radians(0.1);
    camera.calibration_sigma.focal = 0.002;
    camera.calibration_sigma.center = 2;
  }
  return rig;
}

// The corners of a plate where the whole of it is seen, not too far away nor too obliquely.
inline std::optional<FrameCorners> corners_seen(const Rig& rig, std::size_t camera,
                                                const VehiclePose& vehicle,
                                                const SightedPlate& plate) {
  const Eigen::Vector3d from_o = plate.world_from_plate.translation - vehicle.position;
  const double ahead = from_o.dot(plate.world_from_plate.rotation.col(2));
  if (from_o.norm() > 5 || ahead < 0.25 * from_o.norm()) return std::nullopt;
  const auto rows =
      sighting_rows(rig, calibration_layout(rig), {}, vehicle_frame(vehicle), plate, camera);
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4 && rows; ++i) {
    const Eigen::Vector2d pixel = rows->predicted.segment<2>(2 * static_cast<Eigen::Index>(i));
    if (!in_image(rig.cameras[camera].camera, pixel)) return std::nullopt;
    corners[i] = {pixel.x(), pixel.y()};
  }
  return rows ? std::optional(corners) : std::nullopt;
}

inline void drive_by(AsBuiltDrive& drive, const Rig& true_rig, const AsBuiltDriveOptions& options,
                     Draws& draws) {
  const double length = 0.8 * options.pairs;
  for (int s = 0; s < options.stations; ++s) {
    const double chainage = length * (s + 0.5) / options.stations;
    FloorStance stance;
    stance.height = drive.rig.vehicle_height;
    stance.lateral = draws.uniform(-0.3, 0.3);
    stance.yaw = draws.normal(radians(3));
    stance.pitch = draws.normal(radians(1));
    stance.roll = draws.normal(radians(1));
    const VehiclePose vehicle =
        vehicle_on_floor(drive.survey.tunnel.centerline.at(chainage), stance);
    for (std::size_t i = 0; i < drive.survey.tags.size(); ++i) {
      if (std::abs(drive.survey.tags[i].chainage - chainage) > 6) continue;
      SightedPlate plate = sighted_plate(drive.survey.tags[i], drive.survey);
      plate.world_from_plate = drive.hung[i];
      for (std::size_t camera = 0; camera < drive.rig.cameras.size(); ++camera) {
        const auto corners = corners_seen(true_rig, camera, vehicle, plate);
        if (!corners) continue;
        SeenCorners seen{*corners, options.noise, {}};
        for (auto& corner : seen.corners) {
          corner.x += draws.normal(options.noise);
          corner.y += draws.normal(options.noise);
        }
        seen.covariance = options.noise * options.noise * CornerCovariance::Identity();
        drive.sighted.push_back({std::to_string(s), camera, plate.name, seen});
      }
    }
  }
}

inline AsBuiltDrive as_built_drive(const AsBuiltDriveOptions& options, Draws& draws) {
  AsBuiltDrive drive{long_survey(options), wide_rig(), {}, {}, {}};
  const int every = static_cast<int>(std::lround(options.control_every / 0.8));
  for (const PlacedTag& tag : drive.survey.tags) {
    const bool is_control = tag.pair % every == 0 || tag.pair == options.pairs - 1;
    if (is_control) drive.control.push_back(tag.name);
    Pose pose = tag.world_from_plate;
    pose.translation += draws.normals(is_control ? options.control_sigma : options.displaced);
    pose.rotation *= small_turn(draws, options.turned);
    drive.hung.push_back(pose);
  }
  drive_by(drive, disturbed(drive.rig, draws), options, draws);
  return drive;
}

// How far adjusted tags are from where they truly hang.
struct AsBuiltErrors {
  std::vector<double> distances;  // metres
  double nees = 0;                // of P, mean over the tags; 1 = as stated
};

inline AsBuiltErrors errors_of(const AsBuiltDrive& drive, const AsBuiltSurvey& found) {
  AsBuiltErrors errors;
  for (const AsBuiltTag& tag : found.tags) {
    if (tag.status != AsBuiltStatus::adjusted) continue;
    const auto index = static_cast<std::size_t>(find_tag(drive.survey, std::string_view(tag.tag)) -
                                                drive.survey.tags.data());
    const Eigen::Vector3d off = tag.world_from_plate.translation - drive.hung[index].translation;
    errors.distances.push_back(off.norm());
    errors.nees += squared_mahalanobis(off, tag.covariance.topLeftCorner<3, 3>()) / 3;
  }
  errors.nees /= static_cast<double>(errors.distances.size());
  return errors;
}

}  // namespace tagsmith::detail::test
