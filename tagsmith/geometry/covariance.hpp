// SPDX-License-Identifier: Apache-2.0
// Chi-squares and axes of a covariance, propagation of covariances, and linear least squares. These
// are functions of matrices of any size, so that Eigen's solvers and products are compiled only
// here: each further file with them takes the compiler several seconds.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace tagsmith::detail {

// The squared Mahalanobis distance r^T C^-1 r of r from zero: chi-square of r's size in degrees of
// freedom where C is r's covariance. C: symmetric, positive definite, of r's size.
double squared_mahalanobis(const Eigen::Ref<const Eigen::VectorXd>& residual,
                           const Eigen::Ref<const Eigen::MatrixXd>& covariance);

// X with matrix X = right. matrix: symmetric, semidefinite.
Eigen::MatrixXd solve_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                                const Eigen::Ref<const Eigen::MatrixXd>& right);

// X that makes the squares of rows X - right least. rows: at least as many rows as columns.
Eigen::MatrixXd least_squares(const Eigen::Ref<const Eigen::MatrixXd>& rows,
                              const Eigen::Ref<const Eigen::MatrixXd>& right);

// The lower triangular L with L L^T = matrix, and the inverse of a symmetric matrix; nothing unless
// it is positive definite.
std::optional<Eigen::MatrixXd> cholesky_root(const Eigen::Ref<const Eigen::MatrixXd>& matrix);
std::optional<Eigen::MatrixXd> inverse_of_positive(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

// J C J^T: the covariance of J v where C is that of v.
Eigen::MatrixXd propagated(const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                           const Eigen::Ref<const Eigen::MatrixXd>& covariance);

// The same where the components of v are independent.
Eigen::MatrixXd propagated_variances(const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                                     const Eigen::Ref<const Eigen::VectorXd>& variances);

// Multiplies rows whose errors have this covariance by L^-1, where the covariance is L L^T: their
// errors then are independent, of variance 1. False, with the rows unchanged, where the covariance
// is not positive definite.
bool whiten(Eigen::Ref<Eigen::MatrixXd> rows, const Eigen::Ref<const Eigen::MatrixXd>& covariance);

// rows^T rows: the normal matrix of whitened rows.
Eigen::MatrixXd gram(const Eigen::Ref<const Eigen::MatrixXd>& rows);

// Of a symmetric matrix, the least eigenvalue first; the vectors are columns of length 1.
struct PrincipalAxes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

PrincipalAxes principal_axes(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

// The standard deviation in the direction where it is greatest.
double worst_sigma(const Eigen::Matrix3d& covariance);

}  // namespace tagsmith::detail
