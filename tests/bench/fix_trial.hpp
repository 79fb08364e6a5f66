// SPDX-License-Identifier: Apache-2.0
// Simulated measurements for the joint method, from corners on, that benches of positions share.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "tests/bench/bench_site.hpp"
#include "tests/support/draws.hpp"

namespace tagsmith::detail::bench {

// A shipped survey and its rig with standard deviations that a careful calibration leaves.
Result<Site> calibrated_site(const std::string& name);

// The vehicle anywhere beside the survey's tags, as far from level and from the center line as the
// rig says that it may be.
VehiclePose random_pose(const Site& site, test::Draws& draws);

// The plate's corners where the camera sees them; nothing when it does not see all of them well
// enough to read.
// `way`: metres that the vehicle drives while a rolling shutter passes over the image.
std::optional<FrameCorners> corners_in_image(const RigCamera& camera, const VehiclePose& vehicle,
                                             const Pose& world_from_plate, const TagTemplate& tag,
                                             double way = 0);

// The corners with noise of a covariance like the reader's, which they state.
SeenCorners noisy(const FrameCorners& corners, test::Draws& draws);

// The range that a sensor measures there, without noise.
double true_range(const Site& site, const RigRange& range, const Eigen::Vector3d& position);

struct PoseError {
  Eigen::Matrix<double, 6, 1> error;
  PoseCovariance covariance;

  // The largest error of a coordinate of the position, in its standard deviations.
  double greatest_sigmas() const;
};

// Of a fix that has a position.
PoseError error_of(const Fix& fix, const VehiclePose& truth, const Grid& grid);

}  // namespace tagsmith::detail::bench
