// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/covariance.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace tagsmith::detail {

double squared_mahalanobis(const Eigen::Ref<const Eigen::VectorXd>& residual,
                           const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  const Eigen::VectorXd weighed = Eigen::LDLT<Eigen::MatrixXd>(covariance).solve(residual);
  return residual.dot(weighed);
}

Eigen::MatrixXd solve_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                                const Eigen::Ref<const Eigen::MatrixXd>& right) {
  return Eigen::LDLT<Eigen::MatrixXd>(matrix).solve(right);
}

Eigen::MatrixXd least_squares(const Eigen::Ref<const Eigen::MatrixXd>& rows,
                              const Eigen::Ref<const Eigen::MatrixXd>& right) {
  return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(rows).solve(right);
}

std::optional<Eigen::MatrixXd> cholesky_root(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  const Eigen::LLT<Eigen::MatrixXd> root(matrix);
  if (root.info() != Eigen::Success) return std::nullopt;
  return root.matrixL();
}

std::optional<Eigen::MatrixXd> inverse_of_positive(
    const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  const Eigen::LLT<Eigen::MatrixXd> root(matrix);
  if (root.info() != Eigen::Success) return std::nullopt;
  return root.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

Eigen::MatrixXd propagated(const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                           const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  return jacobian * covariance * jacobian.transpose();
}

Eigen::MatrixXd propagated_variances(const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                                     const Eigen::Ref<const Eigen::VectorXd>& variances) {
  return jacobian * variances.asDiagonal() * jacobian.transpose();
}

bool whiten(Eigen::Ref<Eigen::MatrixXd> rows, const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);
  if (root.info() != Eigen::Success) return false;
  root.matrixL().solveInPlace(rows);
  return true;
}

Eigen::MatrixXd gram(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  return rows.transpose() * rows;
}

PrincipalAxes principal_axes(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

double worst_sigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, axes.eigenvalues().maxCoeff()));
}

}  // namespace tagsmith::detail
