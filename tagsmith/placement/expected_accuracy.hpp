// SPDX-License-Identifier: Apache-2.0
// The accuracy of a vehicle's position from the tags it sees: the covariance that the localizer's
// own derivatives predict, before anything is measured.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/placement/sight.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

struct AccuracyOptions {
  // Of a coordinate of a corner, pixels; absent = what the reader was measured to reach.
  std::optional<double> corner_sigma_px;
  // Metres a second: during a camera's exposure it blurs the corners, during its readout it shifts
  // rows.
  double speed = 0;
};

// Standard deviation of a coordinate of the sight's corners, pixels.
double expected_corner_sigma(const Rig& rig, const PlateSight& sight,
                             const AccuracyOptions& options);

// The information of all sights together, with the weights of the joint fit: plates uncertain in
// place and angle, each camera in its mounting, focal length and principal point.
VehicleCovariance sights_information(const Survey& survey, const Rig& rig,
                                     const VehicleFrame& vehicle,
                                     std::span<const PlateSight> sights,
                                     const AccuracyOptions& options);

// Information from all else than tags: the rig's priors of height and attitude above `floor`, the
// center line's place abreast of the vehicle, and its ranges to the walls.
VehicleCovariance rig_information(const Survey& survey, const Rig& rig,
                                  const CenterlinePoint& floor, const VehiclePose& pose);

// The covariance of x, y, z, heading, pitch, roll; nothing when the information is not sufficient.
std::optional<VehicleCovariance> covariance_from(const VehicleCovariance& information);

}  // namespace tagsmith::detail
