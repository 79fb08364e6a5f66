// SPDX-License-Identifier: Apache-2.0
// The normal equations of an adjustment of plates: sparse among the plates, dense in the few
// parameters that all share (the calibration's).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace tagsmith::detail {

inline constexpr Eigen::Index kPlateCount = 7;  // parameters of a plate: shift, turn, size

using PlateVector = Eigen::Matrix<double, kPlateCount, 1>;
using PlateMatrix = Eigen::Matrix<double, kPlateCount, kPlateCount>;

// The elements of the inverse of L D L^T at the places where L has elements, which takes about as
// long as the factorisation (Erisman and Tinney 1975, "On computing certain elements of the inverse
// of a sparse matrix"). L is unit lower triangular, its diagonal not stored, its columns sorted.
class SelectedInverse {
 public:
  SelectedInverse(const Eigen::SparseMatrix<double>& lower, const Eigen::VectorXd& pivots);

  // Where neither L nor its transpose has an element, 0.
  double at(Eigen::Index row, Eigen::Index column) const;

 private:
  void invert(Eigen::Index column, Eigen::VectorXd& factors, Eigen::VectorXd& sums);

  Eigen::SparseMatrix<double> inverse_;
  Eigen::VectorXd diagonal_;
};

// Orders the parameters of normal equations so that the factor stays sparse: the approximate
// minimum degree of plates as wholes (Amestoy, Davis and Duff 1996), because the parameters of one
// plate have the same neighbours. Much faster than the order of each parameter.
struct PlateOrdering {
  using PermutationType = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;

  // `information` with both triangles; `parameters` lists its columns in the order of elimination.
  void operator()(const Eigen::SparseMatrix<double>& information,
                  PermutationType& parameters) const;
};

// A block for each two plates seen together and dense columns of the shared parameters, so that it
// grows with the plates and not with the pictures. Parameters: kPlateCount of each plate, then the
// shared ones.
class PlateNormals {
 public:
  PlateNormals(std::size_t plates, Eigen::Index shared);

  Eigen::Index size() const { return gradient_.size(); }
  Eigen::Index of_plates() const { return size() - by_shared_.cols(); }

  // Adds the normal equations of one station for these plates and the shared parameters, in this
  // order.
  void add(const std::vector<std::size_t>& plates, const Eigen::MatrixXd& information,
           const Eigen::VectorXd& gradient);

  // Adds that a parameter whose error is now `value` has an error of this variance.
  void add_prior(Eigen::Index parameter, double value, double variance);

  // Factorises the sum. False when it is not positive definite.
  bool factorise();

  // Results of the last factorisation. The full step to the minimum:
  Eigen::VectorXd step() const { return -solver_.solve(gradient_); }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const { return solver_.solve(right); }

  // Makes the elements of the inverse that covariance_of asks for.
  void invert();
  // Of these plates together; takes much longer where some of them were not seen together.
  Eigen::MatrixXd covariance_of(const std::vector<std::size_t>& plates) const;

  // The places of the plates' and the shared parameters among all.
  std::vector<Eigen::Index> columns_of(const std::vector<std::size_t>& plates) const;

  static Eigen::Index column_of(std::size_t plate) {
    return kPlateCount * static_cast<Eigen::Index>(plate);
  }

 private:
  std::vector<Eigen::Triplet<double>> entries() const;

  std::map<std::pair<std::size_t, std::size_t>, PlateMatrix> by_plates_;
  Eigen::MatrixXd by_shared_;  // the columns of the shared parameters
  Eigen::VectorXd gradient_;
  Eigen::VectorXd priors_;  // on the diagonal
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, PlateOrdering> solver_;
  std::optional<SelectedInverse> inverse_;
};

}  // namespace tagsmith::detail
