// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fix_trial.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "decoder/feature_frame/corner_covariance.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/observation_model.hpp"

namespace tagsmith::detail::bench {

using Eigen::Vector3d;
using test::Draws;

Result<Site> calibrated_site(const std::string& name) {
  Result<Site> site = load_shipped_site(name);
  if (!site) return site;
  site->survey.angle_sigma = radians(0.1);
  for (RigCamera& camera : site->rig.cameras) {
    camera.calibration_sigma = {0.001, radians(0.05), 5e-4, 0.5};
  }
  return site;
}

VehiclePose random_pose(const Site& site, Draws& draws) {
  const Centerline& line = site.survey.tunnel.centerline;
  const double from = site.survey.tags.front().chainage - 1.5;
  const double to = site.survey.tags.back().chainage;
  const CenterlinePoint at = line.at(draws.uniform(from, to));
  VehiclePose pose;
  const double side = draws.uniform(-0.25, 0.25) * width_at(site.survey.tunnel, 0);
  pose.position = at.position + side * right_of(at.heading);
  pose.position.z() += site.rig.vehicle_height + draws.normal(site.rig.height_sigma);
  pose.heading = at.heading + draws.normal(radians(5));
  pose.pitch = draws.normal(site.rig.pitch_sigma);
  pose.roll = draws.normal(site.rig.roll_sigma);
  return pose;
}

// The plate's corners where the camera sees them; nothing when it does not see all of them well
// enough to read.
std::optional<FrameCorners> corners_in_image(const RigCamera& camera, const VehiclePose& vehicle,
                                             const Pose& world_from_plate, const TagTemplate& tag,
                                             double way) {
  const double length = tag.frame_inner_length;
  const double height = tag.frame_inner_height;
  const Vector3d in_plate[] = {{0, 0, 0}, {length, 0, 0}, {length, height, 0}, {0, height, 0}};
  const VehicleFrame frame = vehicle_frame(vehicle);
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto seen = observe_point(camera.camera, camera.vehicle_from_camera, frame,
                                    world_from_plate, in_plate[i]);
    if (!seen || !in_image(camera.camera, seen->pixel)) return std::nullopt;
    const Eigen::Vector2d pixel = seen->pixel + way * seen->by_motion.col(0);
    corners[i] = {pixel.x(), pixel.y()};
  }
  const double module_px = distance(corners[0], corners[1]) / (95 + 18);
  if (module_px < 0.6 || !is_convex(corners)) return std::nullopt;
  return corners;
}

SeenCorners noisy(const FrameCorners& corners, Draws& draws) {
  RefinedFrame frame;
  frame.corners = corners;
  const double sigma = std::exp(draws.uniform(std::log(0.003), std::log(0.15)));
  for (FrameSide& side : frame.sides) {
    side.blur_px = draws.uniform(0.3, 1.0);
    side.stroke_px = 10;
    side.covariance = sigma * sigma * Eigen::Matrix2d{{1, -0.3}, {-0.3, 1}};
  }
  SeenCorners seen{corners, sigma, corner_covariance(frame)};
  Eigen::Matrix<double, 8, 1> noise;
  for (double& value : noise) value = draws.normal(1);
  noise = seen.covariance.llt().matrixL() * noise;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    seen.corners[i] = corners[i] + PixelPoint{noise[row], noise[row + 1]};
  }
  return seen;
}

double true_range(const Site& site, const RigRange& range, const Vector3d& position) {
  const Tunnel& tunnel = site.survey.tunnel;
  return observe_wall(tunnel.centerline, wall_of(tunnel, range.wall), position).distance;
}

double PoseError::greatest_sigmas() const {
  const Vector3d sigmas = covariance.diagonal().head<3>().cwiseSqrt();
  return error.head<3>().cwiseAbs().cwiseQuotient(sigmas).maxCoeff();
}

PoseError error_of(const Fix& fix, const VehiclePose& truth, const Grid& grid) {
  PoseError result{{}, *fix.pose_covariance_in_grid};
  const Vector3d position = *fix.position_in_grid - grid_from_world(grid, truth.position);
  const double heading = fix.attitude->heading - grid_heading_from_world(grid, truth.heading);
  result.error << position, std::remainder(heading, 2 * std::numbers::pi),
      fix.attitude->pitch - truth.pitch, fix.attitude->roll - truth.roll;
  return result;
}

}  // namespace tagsmith::detail::bench
