// SPDX-License-Identifier: Apache-2.0
// How well a vehicle will know its place from the tags it sees: the covariance that the localizer's
// own derivatives predict, before anything is measured.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/placement/sight.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

struct AccuracyOptions {
  // Of a coordinate of a corner, pixels; absent = what the reader was measured to reach.
  std::optional<double> corner_sigma_px;
  double moved = 0;  // metres that the vehicle moves during the exposure: blurs the corners
};

// A plate's four inner corners as a camera sees them: information about the vehicle's pose, were
// the plate's position known exactly.
VehicleCovariance corner_information(const Survey& survey, const Rig& rig,
                                     const VehicleFrame& vehicle, const PlateSight& sight,
                                     const AccuracyOptions& options);

// What is left of a tag's information when its position has been surveyed with this standard
// deviation of a coordinate, metres.
VehicleCovariance with_survey_error(const VehicleCovariance& information, double survey_sigma);

// Information from all else than tags: the rig's priors of height and attitude and its ranges to
// the walls.
VehicleCovariance rig_information(const Survey& survey, const Rig& rig, const VehiclePose& pose);

// The covariance of x, y, z, heading, pitch, roll; nothing when the information does not suffice.
std::optional<VehicleCovariance> covariance_from(const VehicleCovariance& information);

// The method of Xu et al. (2017) with two tags of facing walls and the distance d to the left wall.
struct PaperExpectation {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of x, y, z, world frame, metres^2
  double magnification = 0;      // 1 / tan(theta): metres along the tunnel for a metre of d
  double no_solution_share = 0;  // of measurements whose d fits no real solution
};

// Of the sights, the pair of tags that the method takes (see localize_by_paper), with D1 and D2
// from the corners P and Q. Nothing without such a pair, without a range to the left wall, or where
// D1, D2 and d do not determine a place at all.
std::optional<PaperExpectation> expect_by_paper(const Survey& survey, const Rig& rig,
                                                const VehiclePose& pose,
                                                std::span<const PlateSight> sights,
                                                const AccuracyOptions& options);

}  // namespace tagsmith
