// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/covariance.hpp"

#include <doctest/doctest.h>

using namespace tagsmith::detail;

TEST_CASE("the squared Mahalanobis distance counts each axis in its standard deviations") {
  const Eigen::Vector2d residual(3, -4);
  CHECK(squared_mahalanobis(residual, Eigen::Vector2d(9, 4).asDiagonal().toDenseMatrix()) ==
        doctest::Approx(1 + 4));
}

TEST_CASE("errors that go together make their common direction likely") {
  Eigen::Matrix2d covariance;
  covariance << 1, 0.99, 0.99, 1;
  // Eigenvalues 1.99 along (1, 1) and 0.01 along (1, -1).
  CHECK(squared_mahalanobis(Eigen::Vector2d(1, 1), covariance) == doctest::Approx(2 / 1.99));
  CHECK(squared_mahalanobis(Eigen::Vector2d(1, -1), covariance) == doctest::Approx(2 / 0.01));
}

TEST_CASE("whitened rows have the squares of their Mahalanobis distance") {
  Eigen::MatrixXd row(2, 1);
  row << 1, -1;
  Eigen::Matrix2d covariance;
  covariance << 1, 0.99, 0.99, 1;
  CHECK(whiten(row, covariance));
  CHECK(row.squaredNorm() == doctest::Approx(2 / 0.01));
  covariance << 1, 2, 2, 1;  // of no errors
  CHECK_FALSE(whiten(row, covariance));
}

TEST_CASE("the worst standard deviation is that of the longest axis, however it lies") {
  Eigen::Matrix3d covariance;
  covariance << 5, 4, 0, 4, 5, 0, 0, 0, 2;  // eigenvalues 9, 1, 2
  CHECK(worst_sigma(covariance) == doctest::Approx(3));
}
