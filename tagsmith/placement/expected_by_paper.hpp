// SPDX-License-Identifier: Apache-2.0
// How well the published method, with two tags of facing walls and the distance to the left wall,
// would know a vehicle's place.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "tagsmith/placement/expected_accuracy.hpp"

namespace tagsmith {

// Of the measurements that have a solution: the others say nothing.
struct PaperExpectation {
  // Mean of the products of the errors in x, y, z about the true place, world frame, metres^2: what
  // the method's own assumptions get wrong there (level cameras at O, straight walls) is in it.
  // Infinite where no measurement has a solution.
  Eigen::Matrix3d mean_square = Eigen::Matrix3d::Zero();
  double magnification = 0;      // 1 / tan(theta): metres along the tunnel for a metre of d
  double no_solution_share = 1;  // of measurements: no real solution, or one below the floor
};

// Of the sights, the pair of tags that the method takes (see localize_by_paper), with D1 and D2
// from the corners P and Q. Nothing without such a pair, without a range to the left wall, or with
// a stagger of zero. D1, D2 and d are varied by their standard deviations over a fixed set of 52
// draws, because the method is far from linear where it has hardly a solution left.
std::optional<PaperExpectation> expect_by_paper(const Survey& survey, const Rig& rig,
                                                const VehiclePose& pose,
                                                std::span<const PlateSight> sights,
                                                const AccuracyOptions& options);

}  // namespace tagsmith
