// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/plate_normals.hpp"

#include <algorithm>

#include <Eigen/OrderingMethods>

namespace tagsmith::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double>;
using Element = SparseMatrix::InnerIterator;

SelectedInverse::SelectedInverse(const SparseMatrix& lower, const VectorXd& pivots)
    : inverse_(lower), diagonal_(pivots.cwiseInverse()) {
  inverse_.makeCompressed();
  VectorXd sums = VectorXd::Zero(inverse_.rows());
  VectorXd factors = VectorXd::Zero(inverse_.rows());  // the column's, 0 elsewhere
  for (Index column = inverse_.cols(); column-- > 0;) invert(column, factors, sums);
}

double SelectedInverse::at(Index row, Index column) const {
  if (row == column) return diagonal_[row];
  return inverse_.coeff(std::max(row, column), std::min(row, column));
}

// The columns behind this one are those of the inverse already. `factors` and `sums` are scratch,
// `factors` zero before and after.
void SelectedInverse::invert(Index column, VectorXd& factors, VectorXd& sums) {
  for (Element own(inverse_, column); own; ++own) {
    factors[own.row()] = own.value();
    sums[own.row()] = 0;
  }
  for (Element own(inverse_, column); own; ++own) {
    const Index row = own.row();
    sums[row] += own.value() * diagonal_[row];
    // Of rows outside the column the sums are not used, and the factors are zero.
    for (Element other(inverse_, row); other; ++other) {
      sums[other.row()] += own.value() * other.value();
      sums[row] += factors[other.row()] * other.value();
    }
  }
  for (Element own(inverse_, column); own; ++own) {
    diagonal_[column] += own.value() * sums[own.row()];
    factors[own.row()] = 0;
    own.valueRef() = -sums[own.row()];
  }
}

void PlateOrdering::operator()(const SparseMatrix& information, PermutationType& parameters) const {
  // The shared parameters, behind those of the plates, make one or more blocks of their own.
  const Index blocks = (information.cols() + kPlateCount - 1) / kPlateCount;
  std::vector<Eigen::Triplet<double>> neighbours;
  for (Index block = 0; block < blocks; ++block) {
    Index last = -1;
    for (Element own(information, kPlateCount * block); own; ++own) {
      if (own.row() / kPlateCount == last) continue;
      last = own.row() / kPlateCount;
      neighbours.emplace_back(last, block, 1);
    }
  }
  SparseMatrix graph(blocks, blocks);
  graph.setFromTriplets(neighbours.begin(), neighbours.end());
  PermutationType order;
  Eigen::AMDOrdering<int>()(graph, order);
  parameters.resize(information.cols());
  Index place = 0;
  for (Index i = 0; i < blocks; ++i) {
    const Index first = kPlateCount * order.indices()[i];
    for (Index j = first; j < std::min(first + kPlateCount, information.cols()); ++j) {
      parameters.indices()[place++] = static_cast<int>(j);
    }
  }
}

PlateNormals::PlateNormals(std::size_t plates, Index shared)
    : by_shared_(MatrixXd::Zero(column_of(plates) + shared, shared)),
      gradient_(VectorXd::Zero(column_of(plates) + shared)),
      priors_(VectorXd::Zero(column_of(plates) + shared)) {}

void PlateNormals::add(const std::vector<std::size_t>& plates, const MatrixXd& information,
                       const VectorXd& gradient) {
  const std::vector<Index> columns = columns_of(plates);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    gradient_[columns[i]] += gradient[static_cast<Index>(i)];
    if (by_shared_.cols() == 0) continue;  // Eigen would count rows from no address
    by_shared_.row(columns[i]) += information.row(static_cast<Index>(i)).tail(by_shared_.cols());
  }
  for (std::size_t i = 0; i < plates.size(); ++i) {
    for (std::size_t j = 0; j < plates.size(); ++j) {
      if (plates[j] > plates[i]) continue;
      auto [block, is_new] = by_plates_.try_emplace({plates[i], plates[j]});
      if (is_new) block->second.setZero();
      block->second += information.block<kPlateCount, kPlateCount>(column_of(i), column_of(j));
    }
  }
}

void PlateNormals::add_prior(Index parameter, double value, double variance) {
  priors_[parameter] += 1 / variance;
  gradient_[parameter] += value / variance;
}

bool PlateNormals::factorise() {
  const std::vector<Eigen::Triplet<double>> all = entries();
  SparseMatrix information(size(), size());
  information.setFromTriplets(all.begin(), all.end());
  solver_.compute(information);
  return solver_.info() == Eigen::Success;
}

void PlateNormals::invert() {
  inverse_.emplace(SparseMatrix(solver_.matrixL().nestedExpression()), solver_.vectorD());
}

MatrixXd PlateNormals::covariance_of(const std::vector<std::size_t>& plates) const {
  std::vector<Index> columns = columns_of(plates);
  columns.resize(kPlateCount * plates.size());
  const auto count = static_cast<Index>(columns.size());
  const bool are_seen_together = std::ranges::all_of(plates, [&](std::size_t one) {
    return std::ranges::all_of(plates, [&](std::size_t other) {
      return by_plates_.contains({std::max(one, other), std::min(one, other)});
    });
  });
  if (!are_seen_together) {
    MatrixXd unit = MatrixXd::Zero(size(), count);
    for (Index i = 0; i < count; ++i) unit(columns[static_cast<std::size_t>(i)], i) = 1;
    return solver_.solve(unit)(columns, Eigen::all);
  }
  const auto& place = solver_.permutationP().indices();
  return MatrixXd::NullaryExpr(count, count, [&](Index i, Index j) {
    return inverse_->at(place[columns[static_cast<std::size_t>(i)]],
                        place[columns[static_cast<std::size_t>(j)]]);
  });
}

std::vector<Index> PlateNormals::columns_of(const std::vector<std::size_t>& plates) const {
  std::vector<Index> columns;
  for (const std::size_t plate : plates) {
    for (Index i = 0; i < kPlateCount; ++i) columns.push_back(column_of(plate) + i);
  }
  for (Index i = of_plates(); i < size(); ++i) columns.push_back(i);
  return columns;
}

// Of the lower triangle.
std::vector<Eigen::Triplet<double>> PlateNormals::entries() const {
  std::vector<Eigen::Triplet<double>> all;
  const auto add = [&all](Index row, Index column, double value) {
    if (column <= row) all.emplace_back(row, column, value);
  };
  for (const auto& [plates, block] : by_plates_) {
    const Index row = column_of(plates.first);
    const Index column = column_of(plates.second);
    for (Index i = 0; i < kPlateCount; ++i) {
      for (Index j = 0; j < kPlateCount; ++j) add(row + i, column + j, block(i, j));
    }
  }
  for (Index i = 0; i < size(); ++i) {
    add(i, i, priors_[i]);
    for (Index j = 0; j < by_shared_.cols(); ++j) {
      // Above the diagonal the block of the plates mirrors the one below.
      const Index column = of_plates() + j;
      i < of_plates() ? add(column, i, by_shared_(i, j)) : add(i, column, by_shared_(i, j));
    }
  }
  return all;
}

}  // namespace tagsmith::detail
