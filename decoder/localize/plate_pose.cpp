// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/plate_pose.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace tagsmith::detail {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// The rectangle's corners from its middle, in the order of FrameCorners.
std::array<Vector3d, 4> corners_about_middle(double length, double height) {
  const double x = length / 2;
  const double y = height / 2;
  return {Vector3d(-x, -y, 0), Vector3d(x, -y, 0), Vector3d(x, y, 0), Vector3d(-x, y, 0)};
}

// Rectangle plane to z = 1, the last element 1: the solution of eight linear equations.
std::optional<Matrix3d> homography(const std::array<Vector3d, 4>& corners,
                                   const std::array<Vector3d, 4>& rays) {
  Eigen::Matrix<double, 8, 8> matrix = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> right;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const double x = corners[i].x();
    const double y = corners[i].y();
    const double u = rays[i].x();
    const double v = rays[i].y();
    matrix.row(row) << x, y, 1, 0, 0, 0, -u * x, -u * y;
    matrix.row(row + 1) << 0, 0, 0, x, y, 1, -v * x, -v * y;
    right.segment<2>(row) << u, v;
  }
  const Eigen::PartialPivLU<Eigen::Matrix<double, 8, 8>> solver(matrix);
  const Eigen::Matrix<double, 8, 1> h = solver.solve(right);
  if (!h.allFinite()) return std::nullopt;
  Matrix3d result;
  result << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  return result;
}

// The greatest singular value: singular values multiply to the determinant, their squares add up to
// the sum of all elements' squares.
double spectral_norm(const Matrix2d& a) {
  const double squares = a.squaredNorm();
  const double product = 2 * a.determinant();
  return std::sqrt((squares + std::sqrt(std::max(0.0, squares * squares - product * product))) / 2);
}

// The rotations whose picture of the plane about its middle has the homography's first derivatives
// there: Collins and Bartoli, Appendix A.
std::optional<std::array<Matrix3d, 2>> rotations(const Matrix3d& h) {
  const Vector2d middle = h.block<2, 1>(0, 2);
  const Matrix2d slope = h.topLeftCorner<2, 2>() - middle * h.block<1, 2>(2, 0);
  // The least turn of the axis (0, 0, 1) to the line of sight to the middle.
  const Vector3d sight = Vector3d(middle.x(), middle.y(), 1).normalized();
  const Matrix3d towards =
      Eigen::Quaterniond(1 + sight.z(), -sight.y(), sight.x(), 0).normalized().toRotationMatrix();
  Eigen::Matrix<double, 2, 3> projection;
  projection << Matrix2d::Identity(), -middle;
  const Matrix2d across = projection * towards.leftCols<2>();
  const Matrix2d a = across.inverse() * slope;
  const double scale = spectral_norm(a);
  if (!(scale > 0) || !(a.determinant() > 0)) return std::nullopt;
  const Matrix2d upper = a / scale;
  const Matrix2d rest = Matrix2d::Identity() - upper.transpose() * upper;
  Vector2d lower(std::sqrt(std::max(0.0, rest(0, 0))), std::sqrt(std::max(0.0, rest(1, 1))));
  if (rest(0, 1) < 0) lower.y() = -lower.y();
  std::array<Matrix3d, 2> both;
  for (std::size_t i = 0; i < 2; ++i) {
    const double sign = i == 0 ? 1.0 : -1.0;
    Matrix3d turned;
    turned.topLeftCorner<2, 2>() = upper;
    turned.block<1, 2>(2, 0) = sign * lower.transpose();
    turned.col(2) = turned.col(0).cross(turned.col(1));
    both[i] = towards * turned;
  }
  return both;
}

// The least-squares place of the middle for a rotation: two linear equations a corner.
Vector3d translation(const Matrix3d& rotation, const std::array<Vector3d, 4>& corners,
                     const std::array<Vector3d, 4>& rays) {
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d turned = rotation * corners[i];
    Eigen::Matrix<double, 2, 3> equation;
    equation << 1, 0, -rays[i].x(), 0, 1, -rays[i].y();
    normal += equation.transpose() * equation;
    right -= equation.transpose() * (equation * turned);
  }
  return normal.ldlt().solve(right);
}

}  // namespace

std::optional<std::array<Pose, 2>> plate_poses(const std::array<Vector3d, 4>& rays, double length,
                                               double height) {
  const std::array<Vector3d, 4> corners = corners_about_middle(length, height);
  const std::optional<Matrix3d> h = homography(corners, rays);
  if (!h) return std::nullopt;
  const auto turned = rotations(*h);
  if (!turned) return std::nullopt;
  std::array<Pose, 2> poses;
  for (std::size_t i = 0; i < 2; ++i) {
    const Matrix3d& rotation = (*turned)[i];
    const Vector3d middle = translation(rotation, corners, rays);
    poses[i] = {rotation, middle + rotation * corners[0]};
    if (!poses[i].translation.allFinite() || middle.z() <= 0) return std::nullopt;
  }
  return poses;
}

}  // namespace tagsmith::detail
