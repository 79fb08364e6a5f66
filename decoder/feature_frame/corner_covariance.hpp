// SPDX-License-Identifier: Apache-2.0
// How well a refined frame's corners are known.
#pragma once

#include <Eigen/Core>

namespace tagsmith::detail {

struct RefinedFrame;

// Of u, v of the four corners in their order, pixels^2.
using CornerCovariance = Eigen::Matrix<double, 8, 8>;

// Each corner is where two fitted sides meet, so neighbouring corners share a side's errors.
// Positive definite: what no fit shows of the lens, the print and the tone curve is added.
CornerCovariance corner_covariance(const RefinedFrame& frame);

}  // namespace tagsmith::detail
