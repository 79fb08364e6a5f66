// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/plate_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using PlateVector = Eigen::Matrix<double, 7, 1>;
using SparseMatrix = Eigen::SparseMatrix<double>;

constexpr Index kPlateCount = 7;        // parameters of a plate: shift, turn, size
constexpr Index kDrifts = 3;            // of a picture: focal length, principal point
constexpr double kFreeSigma = 10;       // metres and radians, of a plate that hangs anywhere
constexpr double kFreeSize = 0.3;       // relative, of a frame of any size
constexpr double kExactSize = 1e-6;     // so small that it is none, and large enough to invert
constexpr double kMostMismatch = 0.25;  // frame diagonals; beyond, a start is no worse

bool hangs_anywhere(PlateFreedom freedom) {
  return freedom == PlateFreedom::place || freedom == PlateFreedom::any;
}

bool has_any_size(PlateFreedom freedom) {
  return freedom == PlateFreedom::size || freedom == PlateFreedom::any;
}

// The rig's, and last that of the frames' common size when it is not exact.
CalibrationLayout layout_of(const AdjustmentProblem& problem) {
  CalibrationLayout layout = problem.calibration.value_or(calibration_layout(*problem.rig));
  if (problem.frame_sigma > 0) layout.sigmas.push_back(problem.frame_sigma);
  return layout;
}

struct AdjustmentState {
  std::vector<Pose> world_from_plate;
  VectorXd size_error;  // of each frame by itself, relative
  std::vector<VehiclePose> vehicles;
  VectorXd calibration;
};

// From P of the frame as drawn to P of one that is larger by this, about the same middle.
Vector3d corner_of_larger(const SightedPlate& plate, double size_error) {
  return -size_error / 2 * Vector3d(plate.length, plate.height, 0);
}

SightedPlate at(SightedPlate plate, const Pose& world_from_plate) {
  plate.world_from_plate = world_from_plate;
  return plate;
}

VehiclePose stepped(VehiclePose vehicle, const Vector6& step) {
  vehicle.position += step.head<3>();
  vehicle.heading += step[vehicle_parameter::kHeading];
  vehicle.pitch += step[vehicle_parameter::kPitch];
  vehicle.roll += step[vehicle_parameter::kRoll];
  return vehicle;
}

Vector3d turn_of(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

// --- starts ---

// The corners' distance from where they are seen, root mean square, in diagonals of the frame.
double mismatch_from(const Rig& rig, const SightedPlate& plate, const Sighting& sighting,
                     const VehiclePose& vehicle) {
  const auto rows = sighting_rows(rig, calibration_layout(rig), {}, vehicle_frame(vehicle), plate,
                                  sighting.camera);
  if (!rows) return std::numeric_limits<double>::infinity();
  const double diagonal = (sighting.pixels.segment<2>(4) - sighting.pixels.segment<2>(0)).norm();
  return (rows->predicted - sighting.pixels).norm() / (2 * diagonal);
}

// The vehicle's pose that most of the plates with a known pose agree with.
std::optional<VehiclePose> start_vehicle(const AdjustmentProblem& problem, const Station& station,
                                         const std::vector<std::optional<Pose>>& known) {
  std::optional<VehiclePose> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Sighting& sighting : station.sightings) {
    if (!known[sighting.plate]) continue;
    const auto poses = vehicle_poses_from(
        *problem.rig, at(problem.plates[sighting.plate], *known[sighting.plate]), sighting);
    if (!poses) continue;
    for (const VehiclePose& pose : *poses) {
      double cost = 0;
      for (const Sighting& other : station.sightings) {
        if (!known[other.plate]) continue;
        const double apart = mismatch_from(
            *problem.rig, at(problem.plates[other.plate], *known[other.plate]), other, pose);
        cost += std::min(apart * apart, kMostMismatch * kMostMismatch);
      }
      if (cost >= least) continue;
      least = cost;
      best = pose;
    }
  }
  return best;
}

// Where the sightings from placed vehicles say that a plate hangs.
std::optional<Pose> start_plate(const AdjustmentProblem& problem, std::size_t plate,
                                const std::vector<std::optional<VehiclePose>>& vehicles) {
  std::vector<std::pair<const Sighting*, VehiclePose>> seen;
  for (std::size_t s = 0; s < problem.stations.size(); ++s) {
    if (!vehicles[s]) continue;
    for (const Sighting& sighting : problem.stations[s].sightings) {
      if (sighting.plate == plate) seen.emplace_back(&sighting, *vehicles[s]);
    }
  }
  std::optional<Pose> best;
  double least = std::numeric_limits<double>::infinity();
  const SightedPlate at_origin = at(problem.plates[plate], Pose{});
  for (const auto& [sighting, vehicle] : seen) {
    const auto plate_from_vehicle = vehicle_poses_from(*problem.rig, at_origin, *sighting);
    if (!plate_from_vehicle) continue;
    for (const VehiclePose& in_plate : *plate_from_vehicle) {
      const Pose pose = world_from_vehicle(vehicle) * inverse(world_from_vehicle(in_plate));
      double cost = 0;
      for (const auto& [other, from] : seen) {
        const double apart = mismatch_from(*problem.rig, at(at_origin, pose), *other, from);
        cost += std::min(apart * apart, kMostMismatch * kMostMismatch);
      }
      if (cost >= least) continue;
      least = cost;
      best = pose;
    }
  }
  return best;
}

// Vehicles from the plates that hang as surveyed, freed plates from those vehicles, and so on.
// Stations that cannot be placed are flagged in `idle`, and of no account.
AdjustmentState start_state(const AdjustmentProblem& problem,
                            const std::vector<PlateFreedom>& freed, std::vector<bool>& idle) {
  std::vector<std::optional<Pose>> plates(problem.plates.size());
  for (std::size_t i = 0; i < plates.size(); ++i) {
    if (!hangs_anywhere(freed[i])) plates[i] = problem.plates[i].world_from_plate;
  }
  std::vector<std::optional<VehiclePose>> vehicles(problem.stations.size());
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t s = 0; s < vehicles.size(); ++s) {
      if (vehicles[s]) continue;
      vehicles[s] = start_vehicle(problem, problem.stations[s], plates);
      changed = changed || vehicles[s];
    }
    for (std::size_t i = 0; i < plates.size(); ++i) {
      if (plates[i]) continue;
      plates[i] = start_plate(problem, i, vehicles);
      changed = changed || plates[i];
    }
  }
  AdjustmentState state;
  for (const auto& vehicle : vehicles) {
    idle.push_back(!vehicle);
    state.vehicles.push_back(vehicle.value_or(VehiclePose{}));
  }
  for (std::size_t i = 0; i < plates.size(); ++i) {
    state.world_from_plate.push_back(plates[i].value_or(problem.plates[i].world_from_plate));
  }
  state.size_error = VectorXd::Zero(static_cast<Index>(problem.plates.size()));
  state.calibration = VectorXd::Zero(static_cast<Index>(layout_of(problem).sigmas.size()));
  return state;
}

// --- one linearisation ---

// A station's normal equations with its vehicle's pose eliminated. Columns: those of each plate
// it sees, then the calibration's.
struct ReducedStation {
  std::vector<std::size_t> plates;
  MatrixXd information;
  VectorXd gradient;
  Matrix6 pose_covariance;
  Eigen::Matrix<double, 6, Eigen::Dynamic> pose_by_rest;
  Vector6 pose_gradient;
  double chi_square = 0;
};

// The sum of the stations' normal equations: a block for each two plates seen together, and dense
// columns of the calibration, so that it grows with the plates and not with the stations.
class NormalBlocks {
 public:
  NormalBlocks(Index of_plates, Index uncertain)
      : by_calibration_(MatrixXd::Zero(of_plates + uncertain, uncertain)) {}

  void add(const ReducedStation& station) {
    const MatrixXd& from = station.information;
    const Index uncertain = by_calibration_.cols();
    const auto count = static_cast<Index>(station.plates.size());
    for (Index i = 0; i < count; ++i) {
      const std::size_t plate = station.plates[static_cast<std::size_t>(i)];
      for (Index j = 0; j < count; ++j) {
        const std::size_t other = station.plates[static_cast<std::size_t>(j)];
        if (other > plate) continue;
        auto [block, is_new] = by_plates_.try_emplace({plate, other});
        if (is_new) block->second.setZero();
        block->second += from.block<kPlateCount, kPlateCount>(kPlateCount * i, kPlateCount * j);
      }
      by_calibration_.middleRows(kPlateCount * static_cast<Index>(plate), kPlateCount) +=
          from.block(kPlateCount * i, kPlateCount * count, kPlateCount, uncertain);
    }
    by_calibration_.bottomRows(uncertain) += from.bottomRightCorner(uncertain, uncertain);
  }

  // Of the lower triangle.
  std::vector<Eigen::Triplet<double>> entries() const {
    std::vector<Eigen::Triplet<double>> all;
    const auto add = [&all](Index row, Index column, double value) {
      if (column <= row) all.emplace_back(row, column, value);
    };
    for (const auto& [plates, block] : by_plates_) {
      const Index row = kPlateCount * static_cast<Index>(plates.first);
      const Index column = kPlateCount * static_cast<Index>(plates.second);
      for (Index i = 0; i < kPlateCount; ++i) {
        for (Index j = 0; j < kPlateCount; ++j) add(row + i, column + j, block(i, j));
      }
    }
    const Index of_plates = by_calibration_.rows() - by_calibration_.cols();
    for (Index i = 0; i < by_calibration_.rows(); ++i) {
      for (Index j = 0; j < by_calibration_.cols(); ++j) {
        // Above the diagonal what is of plates is the mirror image of what is below.
        const Index column = of_plates + j;
        i < of_plates ? add(column, i, by_calibration_(i, j))
                      : add(i, column, by_calibration_(i, j));
      }
    }
    return all;
  }

 private:
  std::map<std::pair<std::size_t, std::size_t>, Eigen::Matrix<double, 7, 7>> by_plates_;
  MatrixXd by_calibration_;
};

// Of the inverse of L D L^T those elements where L has some, which takes about as long as the
// factorisation (Erisman and Tinney 1975, "On computing certain elements of the inverse of a sparse
// matrix"). L is unit lower triangular, its diagonal not stored, its columns sorted.
class SelectedInverse {
 public:
  SelectedInverse(SparseMatrix lower, const VectorXd& pivots)
      : inverse_(std::move(lower)), diagonal_(pivots.cwiseInverse()) {
    inverse_.makeCompressed();
    VectorXd sums = VectorXd::Zero(inverse_.rows());
    VectorXd factors = VectorXd::Zero(inverse_.rows());  // the column's, 0 elsewhere
    for (Index column = inverse_.cols(); column-- > 0;) invert(column, factors, sums);
  }

  // Where neither L nor its transpose has an element, 0.
  double at(Index row, Index column) const {
    if (row == column) return diagonal_[row];
    return inverse_.coeff(std::max(row, column), std::min(row, column));
  }

 private:
  using Element = SparseMatrix::InnerIterator;

  // The columns behind this one are those of the inverse already. `factors` and `sums` are scratch,
  // `factors` zero before and after.
  void invert(Index column, VectorXd& factors, VectorXd& sums) {
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

  SparseMatrix inverse_;
  VectorXd diagonal_;
};

class Network {
 public:
  Network(const AdjustmentProblem& problem, const std::vector<PlateFreedom>& freed,
          std::vector<bool> idle)
      : problem_(problem), layout_(layout_of(problem)), idle_(std::move(idle)) {
    for (std::size_t i = 0; i < problem.plates.size(); ++i) {
      PlateVector variance;
      variance << problem.plates[i].survey_variance, kExactSize * kExactSize;
      if (hangs_anywhere(freed[i])) variance.head<6>().setConstant(kFreeSigma * kFreeSigma);
      if (has_any_size(freed[i])) variance[6] = kFreeSize * kFreeSize;
      variances_.push_back(variance);
    }
  }

  Index size() const { return of_plates() + static_cast<Index>(layout_.sigmas.size()); }

  // Of all corners and priors; infinite when a corner cannot be seen.
  double chi_square(const AdjustmentState& state) const {
    double sum = prior_chi_square(state);
    for (std::size_t s = 0; s < problem_.stations.size(); ++s) {
      const auto station = reduced(state, s, false);
      if (!station) return std::numeric_limits<double>::infinity();
      sum += station->chi_square;
    }
    return sum;
  }

  bool linearise(const AdjustmentState& state) {
    stations_.clear();
    NormalBlocks blocks(of_plates(), size() - of_plates());
    gradient_ = VectorXd::Zero(size());
    for (std::size_t s = 0; s < problem_.stations.size(); ++s) {
      auto station = reduced(state, s, true);
      if (!station) return false;
      const std::vector<Index> columns = columns_of(*station);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        gradient_[columns[i]] += station->gradient[static_cast<Index>(i)];
      }
      blocks.add(*station);
      station->information.resize(0, 0);  // of many stations these are most of the memory
      stations_.push_back(std::move(*station));
    }
    std::vector<Eigen::Triplet<double>> entries = blocks.entries();
    add_priors(state, entries);
    information_.resize(size(), size());
    information_.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(information_);
    return solver_.info() == Eigen::Success;
  }

  // The state after `share` of the full step.
  AdjustmentState stepped_by(const AdjustmentState& state, const VectorXd& step,
                             double share) const {
    AdjustmentState next = state;
    for (std::size_t i = 0; i < next.world_from_plate.size(); ++i) {
      const PlateVector own = share * step.segment<kPlateCount>(column_of(i));
      next.world_from_plate[i].translation += own.head<3>();
      next.world_from_plate[i].rotation *= rotation_of(own.segment<3>(3));
      next.size_error[static_cast<Index>(i)] += own[6];
    }
    next.calibration += share * step.tail(next.calibration.size());
    for (std::size_t s = 0; s < stations_.size(); ++s) {
      const ReducedStation& station = stations_[s];
      const std::vector<Index> columns = columns_of(station);
      VectorXd own(static_cast<Index>(columns.size()));
      for (std::size_t i = 0; i < columns.size(); ++i) {
        own[static_cast<Index>(i)] = step[columns[i]];
      }
      const Vector6 pose =
          -station.pose_covariance * (station.pose_gradient + station.pose_by_rest * own);
      next.vehicles[s] = stepped(next.vehicles[s], share * pose);
    }
    return next;
  }

  VectorXd full_step() const { return -solver_.solve(gradient_); }

  // The inverse of the last linearisation, for covariance_of.
  void invert() {
    inverse_.emplace(SparseMatrix(solver_.matrixL().nestedExpression()), solver_.vectorD());
  }

  // Of a plate's parameters, everything else taken along. The plate is in a station.
  Eigen::Matrix<double, 7, 7> covariance_of(std::size_t plate) const {
    Eigen::Matrix<double, 7, 7> covariance;
    const auto& place = solver_.permutationP().indices();
    for (Index i = 0; i < kPlateCount; ++i) {
      for (Index j = 0; j < kPlateCount; ++j) {
        covariance(i, j) = inverse_->at(place[column_of(plate) + i], place[column_of(plate) + j]);
      }
    }
    return covariance;
  }

  // Of the calibration's errors and of the mean heading, pitch and roll of all vehicles.
  MatrixXd calibration_covariance() const {
    const Index uncertain = size() - of_plates();
    MatrixXd by_rest = MatrixXd::Zero(uncertain + 3, size());
    by_rest.topRightCorner(uncertain, uncertain).setIdentity();
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
    const auto placed = static_cast<double>(std::ranges::count(idle_, false));
    for (const ReducedStation& station : stations_) {
      const MatrixXd by_columns = station.pose_covariance * station.pose_by_rest / -placed;
      const std::vector<Index> columns = columns_of(station);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        by_rest.col(columns[i]).tail<3>() += by_columns.col(static_cast<Index>(i)).tail<3>();
      }
      own += station.pose_covariance.bottomRightCorner<3, 3>() / (placed * placed);
    }
    MatrixXd covariance = by_rest * solver_.solve(MatrixXd(by_rest.transpose()));
    covariance.bottomRightCorner<3, 3>() += own;
    return covariance;
  }

  const PlateVector& variance_of(std::size_t plate) const { return variances_[plate]; }
  const std::vector<ReducedStation>& stations() const { return stations_; }
  bool is_idle(std::size_t station) const { return idle_[station]; }

  // Shift and turn of a plate from its surveyed place, and its size from the template's.
  PlateVector moved_by(const AdjustmentState& state, std::size_t plate) const {
    const Pose& surveyed = problem_.plates[plate].world_from_plate;
    const Pose& pose = state.world_from_plate[plate];
    PlateVector moved;
    moved << pose.translation - surveyed.translation,
        turn_of(surveyed.rotation.transpose() * pose.rotation),
        state.size_error[static_cast<Index>(plate)];
    return moved;
  }

 private:
  Index of_plates() const { return column_of(problem_.plates.size()); }

  static Index column_of(std::size_t plate) { return kPlateCount * static_cast<Index>(plate); }

  std::vector<Index> columns_of(const ReducedStation& station) const {
    std::vector<Index> columns;
    for (const std::size_t plate : station.plates) {
      for (Index i = 0; i < kPlateCount; ++i) columns.push_back(column_of(plate) + i);
    }
    for (Index i = of_plates(); i < size(); ++i) columns.push_back(i);
    return columns;
  }

  double prior_chi_square(const AdjustmentState& state) const {
    double sum = 0;
    for (std::size_t i = 0; i < problem_.plates.size(); ++i) {
      sum += moved_by(state, i).cwiseAbs2().cwiseQuotient(variances_[i]).sum();
    }
    for (Index i = 0; i < state.calibration.size(); ++i) {
      sum += std::pow(state.calibration[i] / layout_.sigmas[static_cast<std::size_t>(i)], 2);
    }
    return sum;
  }

  void add_priors(const AdjustmentState& state, std::vector<Eigen::Triplet<double>>& entries) {
    const auto add = [&](Index i, double value, double variance) {
      entries.emplace_back(i, i, 1 / variance);
      gradient_[i] += value / variance;
    };
    for (std::size_t plate = 0; plate < problem_.plates.size(); ++plate) {
      const PlateVector moved = moved_by(state, plate);
      for (Index i = 0; i < kPlateCount; ++i) {
        add(column_of(plate) + i, moved[i], variances_[plate][i]);
      }
    }
    for (Index i = 0; i < state.calibration.size(); ++i) {
      const double sigma = layout_.sigmas[static_cast<std::size_t>(i)];
      add(of_plates() + i, state.calibration[i], sigma * sigma);
    }
  }

  struct SizedRows : SightingRows {
    Eigen::Matrix<double, kSightingRows, 1> by_size;
  };

  // Of a frame of the size that it has in this state, by the plate's pose and by that size.
  std::optional<SizedRows> rows_of(const AdjustmentState& state, const VehicleFrame& frame,
                                   const Sighting& sighting) const {
    const SightedPlate& drawn = problem_.plates[sighting.plate];
    double size_error = state.size_error[static_cast<Index>(sighting.plate)];
    if (problem_.frame_sigma > 0) size_error += state.calibration[state.calibration.size() - 1];
    SightedPlate plate = at(drawn, state.world_from_plate[sighting.plate]);
    const Eigen::Matrix3d& rotation = plate.world_from_plate.rotation;
    const Vector3d corner = corner_of_larger(drawn, size_error);
    plate.world_from_plate.translation += rotation * corner;
    plate.length *= 1 + size_error;
    plate.height *= 1 + size_error;
    const auto rows =
        sighting_rows(*problem_.rig, layout_, state.calibration, frame, plate, sighting.camera);
    if (!rows) return std::nullopt;
    SizedRows sized{*rows, {}};
    // A turn about P of the frame as drawn moves the P that is seen.
    Eigen::Matrix3d across;
    across << 0, -corner.z(), corner.y(), corner.z(), 0, -corner.x(), -corner.y(), corner.x(), 0;
    sized.by_plate.rightCols<3>() -= rows->by_plate.leftCols<3>() * rotation * across;
    for (Index i = 0; i < 4; ++i) {
      const Vector3d from_middle((i == 1 || i == 2 ? 0.5 : -0.5) * drawn.length,
                                 (i >= 2 ? 0.5 : -0.5) * drawn.height, 0);
      sized.by_size.segment<2>(2 * i) =
          rows->by_plate.block<2, 3>(2 * i, 0) * rotation * from_middle;
    }
    return sized;
  }

  // How far a vehicle is from what is known of it, in standard deviations.
  static Vector6 whitened(const VehiclePrior& prior, const VehiclePose& vehicle) {
    Vector6 off;
    off << vehicle.position - prior.mean.position,
        wrapped_angle(vehicle.heading - prior.mean.heading), vehicle.pitch - prior.mean.pitch,
        vehicle.roll - prior.mean.roll;
    return off.cwiseQuotient(prior.sigma);
  }

  // Without derivatives only chi_square is filled.
  std::optional<ReducedStation> reduced(const AdjustmentState& state, std::size_t index,
                                        bool derivatives) const {
    if (idle_[index]) return idle_station();
    const Station& station = problem_.stations[index];
    const VehicleFrame frame = vehicle_frame(state.vehicles[index]);
    ReducedStation result;
    for (const Sighting& sighting : station.sightings) {
      if (std::ranges::find(result.plates, sighting.plate) == result.plates.end()) {
        result.plates.push_back(sighting.plate);
      }
    }
    const auto count = kSightingRows * static_cast<Index>(station.sightings.size());
    const Index calibration = column_of(result.plates.size());
    VectorXd residual(count);
    MatrixXd by_pose = MatrixXd::Zero(count, 6);
    MatrixXd by_rest = MatrixXd::Zero(count, calibration + state.calibration.size());
    MatrixXd by_drift = MatrixXd::Zero(count, kDrifts * static_cast<Index>(layout_.places.size()));
    Index row = 0;
    for (const Sighting& sighting : station.sightings) {
      const auto rows = rows_of(state, frame, sighting);
      if (!rows) return std::nullopt;
      residual.segment<kSightingRows>(row) = rows->predicted - sighting.pixels;
      by_pose.middleRows<kSightingRows>(row) = rows->by_vehicle;
      const auto place = std::ranges::find(result.plates, sighting.plate) - result.plates.begin();
      const Index own = kPlateCount * static_cast<Index>(place);
      by_rest.block<kSightingRows, 6>(row, own) = rows->by_plate;
      by_rest.block<kSightingRows, 1>(row, own + 6) = rows->by_size;
      if (problem_.frame_sigma > 0) {
        by_rest.block<kSightingRows, 1>(row, by_rest.cols() - 1) = rows->by_size;
      }
      for (std::size_t i = 0; i < kCalibrationCount; ++i) {
        const int column = layout_.places[sighting.camera][i];
        if (column < 0) continue;
        by_rest.block<kSightingRows, 1>(row, calibration + column) =
            rows->by_calibration.col(static_cast<Index>(i));
      }
      by_drift.block<kSightingRows, kDrifts>(row, kDrifts * static_cast<Index>(sighting.camera)) =
          sighting.by_drift;
      const Eigen::LLT<CornerCovariance> root(sighting.covariance_with_edges());
      if (root.info() != Eigen::Success) return std::nullopt;
      const auto whiten = [&](auto&& block) { root.matrixL().solveInPlace(block); };
      whiten(residual.segment<kSightingRows>(row));
      whiten(by_pose.middleRows<kSightingRows>(row));
      whiten(by_rest.middleRows<kSightingRows>(row));
      whiten(by_drift.middleRows<kSightingRows>(row));
      row += kSightingRows;
    }
    if (!by_drift.isZero()) {
      const MatrixXd unit = MatrixXd::Identity(count, count);
      const Eigen::LLT<MatrixXd> root(unit + by_drift * by_drift.transpose());
      root.matrixL().solveInPlace(residual);
      root.matrixL().solveInPlace(by_pose);
      root.matrixL().solveInPlace(by_rest);
    }
    result.chi_square = residual.squaredNorm();
    Vector6 by_prior = Vector6::Zero();
    Vector6 prior_information = Vector6::Zero();
    if (station.prior) {
      const Vector6 off = whitened(*station.prior, state.vehicles[index]);
      by_prior = off.cwiseQuotient(station.prior->sigma);
      prior_information = station.prior->sigma.cwiseAbs2().cwiseInverse();
      result.chi_square += off.squaredNorm();
    }
    if (!derivatives) return result;
    Matrix6 pose_information = by_pose.transpose() * by_pose;
    pose_information.diagonal() += prior_information;
    const Eigen::LLT<Matrix6> root(pose_information);
    if (root.info() != Eigen::Success) return std::nullopt;
    result.pose_covariance = root.solve(Matrix6::Identity());
    result.pose_by_rest = by_pose.transpose() * by_rest;
    result.pose_gradient = by_pose.transpose() * residual + by_prior;
    const MatrixXd gain = result.pose_by_rest.transpose() * result.pose_covariance;
    result.information = by_rest.transpose() * by_rest - gain * result.pose_by_rest;
    result.gradient = by_rest.transpose() * residual - gain * result.pose_gradient;
    return result;
  }

  // Of which nothing is known, and that moves nothing.
  ReducedStation idle_station() const {
    ReducedStation station;
    const Index columns = static_cast<Index>(layout_.sigmas.size());
    station.information = MatrixXd::Zero(columns, columns);
    station.gradient = VectorXd::Zero(columns);
    station.pose_covariance.setZero();
    station.pose_by_rest.setZero(6, columns);
    station.pose_gradient.setZero();
    return station;
  }

  const AdjustmentProblem& problem_;
  CalibrationLayout layout_;
  std::vector<bool> idle_;
  std::vector<PlateVector> variances_;
  std::vector<ReducedStation> stations_;
  VectorXd gradient_;
  SparseMatrix information_;
  Eigen::SimplicialLDLT<SparseMatrix> solver_;
  std::optional<SelectedInverse> inverse_;
};

// --- what comes of it ---

// What everything but the plate's own prior says, from the posterior mean `moved` and covariance:
// dividing the prior (variance S, mean 0) out of the posterior. In units of the prior, with P the
// posterior covariance and Q = I - P: mean Q^-1 d, covariance Q^-1 P.
PlateOffset offset_of(const Vector6& moved, const Matrix6& posterior, const Vector6& prior,
                      const Vector6& surveyed) {
  constexpr double kLeast = 1e-9;  // share of what is known of a direction that pictures tell
  const Vector6 sigmas = prior.cwiseSqrt();
  const Vector6 inverse_sigmas = sigmas.cwiseInverse();
  const Matrix6 scaled = inverse_sigmas.asDiagonal() * posterior * inverse_sigmas.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6> axes(Matrix6::Identity() - scaled);
  const Vector6 told = axes.eigenvalues().cwiseMax(kLeast);
  const Vector6 along = axes.eigenvectors().transpose() * inverse_sigmas.cwiseProduct(moved);
  const Matrix6 back = sigmas.asDiagonal() * axes.eigenvectors();
  const Vector6 mean = back * along.cwiseQuotient(told);
  const Vector6 variance = (Vector6::Ones() - told).cwiseMax(0).cwiseQuotient(told);
  PlateOffset offset;
  offset.shift = mean.head<3>();
  offset.turn = mean.tail<3>();
  offset.covariance = back * variance.asDiagonal() * back.transpose();
  Matrix6 expected = offset.covariance;
  expected.diagonal() += surveyed;
  offset.chi_square = squared_mahalanobis(mean, expected);
  offset.shift_chi_square = squared_mahalanobis(offset.shift, expected.topLeftCorner<3, 3>());
  offset.turn_chi_square = squared_mahalanobis(offset.turn, expected.bottomRightCorner<3, 3>());
  return offset;
}

// Minimises from the start. False when it does not get there.
bool converge(Network& network, AdjustmentState& state) {
  constexpr int kMostSteps = 30;
  constexpr int kMostHalvings = 8;
  constexpr double kEnough = 1e-3;  // of chi-square
  double cost = network.chi_square(state);
  for (int i = 0; i < kMostSteps; ++i) {
    if (!std::isfinite(cost) || !network.linearise(state)) return false;
    const VectorXd step = network.full_step();
    double share = 1;
    AdjustmentState next = network.stepped_by(state, step, share);
    double next_cost = network.chi_square(next);
    for (int halved = 0; halved < kMostHalvings && !(next_cost <= cost); ++halved) {
      share /= 2;
      next = network.stepped_by(state, step, share);
      next_cost = network.chi_square(next);
    }
    if (!(next_cost <= cost)) return true;  // as low as rounding lets it
    const bool settled = cost - next_cost < kEnough;
    state = std::move(next);
    cost = next_cost;
    if (settled) break;
  }
  return network.linearise(state);
}

}  // namespace

std::vector<SinglePose> single_poses(const AdjustmentProblem& problem, const Sighting& sighting) {
  AdjustmentProblem alone{problem.rig, {problem.plates[sighting.plate]}, {{"", {sighting}}}};
  alone.stations[0].sightings[0].plate = 0;
  alone.plates[0].survey_variance.setConstant(1e-12);
  std::vector<SinglePose> poses;
  const auto starts = vehicle_poses_from(*problem.rig, alone.plates[0], sighting);
  if (!starts) return poses;
  const auto uncertain = static_cast<Index>(calibration_layout(*problem.rig).sigmas.size());
  for (const VehiclePose& start : *starts) {
    AdjustmentState state{
        {alone.plates[0].world_from_plate}, VectorXd::Zero(1), {start}, VectorXd::Zero(uncertain)};
    Network network(alone, {PlateFreedom::none}, {false});
    if (!converge(network, state)) continue;
    const ReducedStation& station = network.stations()[0];
    const Eigen::Matrix3d axes = vehicle_frame(state.vehicles[0]).turn_axes;
    const Eigen::Matrix3d of_turn = station.pose_covariance.bottomRightCorner<3, 3>();
    poses.push_back({state.vehicles[0], axes * of_turn * axes.transpose(), station.chi_square});
  }
  std::ranges::sort(poses, {}, &SinglePose::chi_square);
  return poses;
}

std::optional<Adjustment> adjust_plates(const AdjustmentProblem& problem,
                                        const std::vector<PlateFreedom>& freed) {
  std::vector<bool> idle;
  AdjustmentState state = start_state(problem, freed, idle);
  Network network(problem, freed, std::move(idle));
  if (!converge(network, state)) return std::nullopt;
  network.invert();
  Adjustment result;
  result.world_from_plate = state.world_from_plate;
  result.chi_square = network.chi_square(state);
  result.offsets.resize(problem.plates.size());
  result.size.resize(problem.plates.size(), 1);
  result.size_sigma.resize(problem.plates.size(), 0);
  result.calibration = state.calibration;
  if (problem.calibration) result.calibration_covariance = network.calibration_covariance();
  for (std::size_t s = 0; s < problem.stations.size(); ++s) {
    const ReducedStation& station = network.stations()[s];
    result.station_chi_square.push_back(station.chi_square);
    result.vehicles.emplace_back();
    if (!network.is_idle(s)) result.vehicles.back() = state.vehicles[s];
    for (const std::size_t plate : station.plates) {
      if (result.offsets[plate]) continue;
      const auto covariance = network.covariance_of(plate);
      const PlateVector moved = network.moved_by(state, plate);
      result.offsets[plate] =
          offset_of(moved.head<6>(), covariance.topLeftCorner<6, 6>(),
                    network.variance_of(plate).head<6>(), problem.plates[plate].survey_variance);
      result.size[plate] += moved[6];
      if (has_any_size(freed[plate])) result.size_sigma[plate] = std::sqrt(covariance(6, 6));
    }
  }
  return result;
}

double mismatch(const AdjustmentProblem& problem, const Sighting& a, const Sighting& b) {
  double least = std::numeric_limits<double>::infinity();
  const auto poses = vehicle_poses_from(*problem.rig, problem.plates[a.plate], a);
  if (!poses) return least;
  for (const VehiclePose& pose : *poses) {
    least = std::min(least, mismatch_from(*problem.rig, problem.plates[b.plate], b, pose));
  }
  return least;
}

bool make_consistent(const AdjustmentProblem& problem, Sighting& sighting) {
  constexpr int kFree = 2;            // eight coordinates less six of the pose
  constexpr double kAsStated = 13.8;  // chi-square that is exceeded once in a thousand
  constexpr double kMostRaised = 100;
  const std::vector<SinglePose> poses = single_poses(problem, sighting);
  if (poses.empty() || poses[0].chi_square > kFree * kMostRaised) return false;
  if (poses[0].chi_square > kAsStated) sighting.covariance *= poses[0].chi_square / kFree;
  return true;
}

}  // namespace tagsmith::detail
