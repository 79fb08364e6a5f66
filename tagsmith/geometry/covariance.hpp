// SPDX-License-Identifier: Apache-2.0
// What a covariance says of a vector.
#pragma once

#include <Eigen/Core>

namespace tagsmith::detail {

// The squared Mahalanobis distance r^T C^-1 r of r from zero: chi-square of r's size in degrees of
// freedom where C is r's covariance. C: symmetric, positive definite, of r's size.
double squared_mahalanobis(const Eigen::Ref<const Eigen::VectorXd>& residual,
                           const Eigen::Ref<const Eigen::MatrixXd>& covariance);

// The standard deviation in the direction where it is greatest.
double worst_sigma(const Eigen::Matrix3d& covariance);

}  // namespace tagsmith::detail
