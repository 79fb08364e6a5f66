// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/joint_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <ceres/tiny_solver.h>

#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index kVehicleCount = vehicle_parameter::kCount;
constexpr Index kPriorRows = 3;

std::optional<SightingRows> rows_of(const JointProblem& problem, const CalibrationLayout& layout,
                                    const JointState& state, const VehicleFrame& frame,
                                    const Sighting& sighting) {
  return sighting_rows(*problem.rig, layout, state.calibration, frame,
                       problem.plates[sighting.plate], sighting.camera);
}

// Derivatives by all parameters of the fit.
void place_columns(const CalibrationLayout& layout, const SightingRows& rows, std::size_t camera,
                   Eigen::Ref<MatrixXd> jacobian) {
  jacobian.setZero();
  jacobian.leftCols<kVehicleCount>() = rows.by_vehicle;
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const int place = layout.places[camera][i];
    if (place >= 0) {
      jacobian.col(kVehicleCount + place) = rows.by_calibration.col(static_cast<Index>(i));
    }
  }
}

// The vehicle's stance minus the expected one on the floor below it: height, pitch and roll, each
// divided by its standard deviation.
struct PriorRows {
  Eigen::Matrix<double, kPriorRows, 1> residual;
  Eigen::Matrix<double, kPriorRows, kVehicleCount> jacobian;
};

PriorRows prior_rows(const JointProblem& problem, const VehiclePose& vehicle) {
  const ObservedStance stance = observe_stance(problem.tunnel->centerline, vehicle);
  const Eigen::Array3d sigmas(problem.rig->height_sigma, problem.rig->pitch_sigma,
                              problem.rig->roll_sigma);
  PriorRows rows{stance.height_pitch_roll, stance.by_vehicle};
  rows.residual[0] -= problem.rig->vehicle_height;
  rows.residual.array() /= sigmas;
  rows.jacobian.array().colwise() /= sigmas;
  return rows;
}

// The state after a step of the parameters.
JointState moved(const JointState& start, const double* step) {
  JointState state = start;
  state.vehicle.position += Vector3d(step[0], step[1], step[2]);
  state.vehicle.heading += step[vehicle_parameter::kHeading];
  state.vehicle.pitch += step[vehicle_parameter::kPitch];
  state.vehicle.roll += step[vehicle_parameter::kRoll];
  for (Index i = 0; i < state.calibration.size(); ++i) {
    state.calibration[i] += step[kVehicleCount + i];
  }
  return state;
}

std::vector<WhitenedRows::Plate> group_by_plate(const JointProblem& problem,
                                                const Selection& selection) {
  std::vector<WhitenedRows::Plate> plates;
  for (const std::size_t sighting : selection.sightings) {
    const std::size_t plate = problem.sightings[sighting].plate;
    auto found = std::ranges::find(plates, plate, &WhitenedRows::Plate::plate);
    if (found == plates.end()) {
      plates.push_back({plate, {}, 0, {}});
      found = plates.end() - 1;
    }
    found->sightings.push_back(sighting);
  }
  return plates;
}

// Everything that one linearisation needs, for Ceres and for the steps after it.
class Linearisation {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  Linearisation(const JointProblem& problem, const Selection& selection, JointState start)
      : problem_(problem),
        layout_(calibration_layout_of_moment(*problem.rig)),
        selection_(selection) {
    if (start.calibration.size() == 0) {
      start.calibration = VectorXd::Zero(static_cast<Index>(layout_.sigmas.size()));
    }
    start_ = std::move(start);
    rows_.plates = group_by_plate(problem, selection);
    Index row = 0;
    for (WhitenedRows::Plate& plate : rows_.plates) {
      plate.begin = row;
      row += kSightingRows * static_cast<Index>(plate.sightings.size());
    }
    rows_.ranges_begin = row;
    rows_.vehicle_begin = row + static_cast<Index>(selection.ranges.size());
    rows_.calibration_begin = rows_.vehicle_begin + kPriorRows;
    count_ = rows_.calibration_begin + start_.calibration.size();
  }

  int NumResiduals() const { return static_cast<int>(count_); }
  int NumParameters() const { return static_cast<int>(kVehicleCount + start_.calibration.size()); }
  const JointState& start() const { return start_; }

  // Ceres' cost function: `step` from the start. A pose from which a corner cannot be seen costs
  // more than any other.
  bool operator()(const double* step, double* residual, double* jacobian) const {
    constexpr double kBeyond = 1e9;
    Eigen::Map<VectorXd> f(residual, NumResiduals());
    MatrixXd own;
    if (jacobian == nullptr) own.resize(NumResiduals(), NumParameters());
    Eigen::Map<MatrixXd> j(jacobian == nullptr ? own.data() : jacobian, NumResiduals(),
                           NumParameters());
    if (evaluate(moved(start_, step), f, j)) return true;
    f.setConstant(kBeyond);
    j.setZero();
    return false;
  }

  // Weighs the plates' rows by their covariance as seen from `state`.
  bool weigh(const JointState& state) {
    const VehicleFrame frame = vehicle_frame(state.vehicle);
    for (WhitenedRows::Plate& group : rows_.plates) {
      const auto size = kSightingRows * static_cast<Index>(group.sightings.size());
      MatrixXd covariance = MatrixXd::Zero(size, size);
      MatrixXd by_plate(size, 6);
      Index row = 0;
      for (const std::size_t index : group.sightings) {
        const Sighting& sighting = problem_.sightings[index];
        const auto rows = rows_of(problem_, layout_, state, frame, sighting);
        if (!rows) return false;
        by_plate.middleRows<kSightingRows>(row) = rows->by_plate;
        covariance.block<kSightingRows, kSightingRows>(row, row) =
            problem_.edges_weigh ? sighting.covariance_with_edges() : sighting.covariance;
        row += kSightingRows;
      }
      const SightedPlate& plate = problem_.plates[group.plate];
      const Eigen::Matrix<double, 6, 1> variance = plate.survey_variance + plate.coding_variance;
      covariance += propagated_variances(by_plate, variance);
      auto root = cholesky_root(covariance);
      if (!root) return false;
      group.root = std::move(*root);
    }
    return true;
  }

  std::optional<JointFit> fit_at(const JointState& state) {
    JointFit fit;
    rows_.residual.resize(count_);
    rows_.jacobian.resize(count_, NumParameters());
    if (!evaluate(state, rows_.residual, rows_.jacobian)) return std::nullopt;
    auto covariance = inverse_of_positive(gram(rows_.jacobian));
    if (!covariance) return std::nullopt;
    fit.covariance = std::move(*covariance);
    fit.chi_square = rows_.residual.squaredNorm();
    fit.degrees_of_freedom = static_cast<int>(count_) - NumParameters();
    fit.state = state;
    fit.selection = selection_;
    fit.rows = rows_;
    return fit;
  }

 private:
  template <typename F, typename J>
  bool evaluate(const JointState& state, F& f, J& j) const {
    const VehicleFrame frame = vehicle_frame(state.vehicle);
    j.setZero();
    for (const WhitenedRows::Plate& group : rows_.plates) {
      Index row = group.begin;
      for (const std::size_t index : group.sightings) {
        const Sighting& sighting = problem_.sightings[index];
        const auto rows = rows_of(problem_, layout_, state, frame, sighting);
        if (!rows) return false;
        f.template segment<kSightingRows>(row) = rows->predicted - sighting.pixels;
        place_columns(layout_, *rows, sighting.camera, j.template middleRows<kSightingRows>(row));
        row += kSightingRows;
      }
      const auto root = group.root.template triangularView<Eigen::Lower>();
      root.solveInPlace(f.segment(group.begin, row - group.begin));
      root.solveInPlace(j.middleRows(group.begin, row - group.begin));
    }
    evaluate_ranges(state, f, j);
    const PriorRows prior = prior_rows(problem_, state.vehicle);
    f.template segment<kPriorRows>(rows_.vehicle_begin) = prior.residual;
    j.template block<kPriorRows, kVehicleCount>(rows_.vehicle_begin, 0) = prior.jacobian;
    for (Index i = 0; i < state.calibration.size(); ++i) {
      const double sigma = layout_.sigmas[static_cast<std::size_t>(i)];
      f[rows_.calibration_begin + i] = state.calibration[i] / sigma;
      j(rows_.calibration_begin + i, kVehicleCount + i) = 1 / sigma;
    }
    return true;
  }

  template <typename F, typename J>
  void evaluate_ranges(const JointState& state, F& f, J& j) const {
    Index row = rows_.ranges_begin;
    for (const std::size_t index : selection_.ranges) {
      const WallRange& range = problem_.ranges[index];
      const ObservedWall wall =
          observe_wall(problem_.tunnel->centerline, wall_of(*problem_.tunnel, range.wall),
                       state.vehicle.position);
      f[row] = (wall.distance - range.distance) / range.sigma;
      j.template block<1, 3>(row, 0) = wall.by_position.transpose() / range.sigma;
      ++row;
    }
  }

  const JointProblem& problem_;
  CalibrationLayout layout_;
  Selection selection_;
  JointState start_;
  WhitenedRows rows_;
  Index count_ = 0;
};

// A plate's part of a fit's rows.
struct PlateRows {
  VectorXd residual;
  MatrixXd jacobian;
  // Covariance of the residual at the solution, I - J P J^T. Its inverse turns the residual into
  // that against a fit without the plate (Cook and Weisberg 1982, "Residuals and Influence in
  // Regression", 2.2).
  MatrixXd left;
};

PlateRows plate_rows(const JointFit& fit, std::size_t index) {
  const WhitenedRows::Plate& group = fit.rows.plates[index];
  const auto size = kSightingRows * static_cast<Index>(group.sightings.size());
  PlateRows rows{fit.rows.residual.segment(group.begin, size),
                 fit.rows.jacobian.middleRows(group.begin, size), MatrixXd::Identity(size, size)};
  rows.left -= propagated(rows.jacobian, fit.covariance);
  return rows;
}

// Why: docs/decisions/0007-corner-covariance.md.
Eigen::Matrix<double, 6, 1> variance_of(const SightedPlate& plate) {
  return plate.survey_variance + plate.coding_variance;
}

}  // namespace

std::optional<JointFit> fit_jointly(const JointProblem& problem, const Selection& selection,
                                    const VehiclePose& start) {
  JointState state{start, {}};
  // The weights are constant during a solution; the second starts where they hardly change any
  // more.
  for (const int iterations : {30, 10}) {
    Linearisation linearisation(problem, selection, state);
    if (!linearisation.weigh(state)) return std::nullopt;
    ceres::TinySolver<Linearisation> solver;
    solver.options.max_num_iterations = iterations;
    solver.options.gradient_tolerance = 1e-9;
    solver.options.function_tolerance = 1e-7;
    VectorXd step = VectorXd::Zero(linearisation.NumParameters());
    solver.Solve(linearisation, &step);
    if (!step.allFinite()) return std::nullopt;
    state = moved(linearisation.start(), step.data());
  }
  Linearisation linearisation(problem, selection, state);
  if (!linearisation.weigh(state)) return std::nullopt;
  return linearisation.fit_at(state);
}

std::optional<Disagreement> disagreement(const JointProblem& problem, const JointFit& fit,
                                         std::size_t index) {
  const CalibrationLayout layout = calibration_layout_of_moment(*problem.rig);
  const Sighting& sighting = problem.sightings[index];
  const SightedPlate& plate = problem.plates[sighting.plate];
  const auto rows = rows_of(problem, layout, fit.state, vehicle_frame(fit.state.vehicle), sighting);
  if (!rows) return std::nullopt;
  MatrixXd jacobian(kSightingRows, fit.covariance.cols());
  place_columns(layout, *rows, sighting.camera, jacobian);
  const Eigen::Matrix<double, 6, 1> variance = variance_of(plate);
  const MatrixXd by_shift = rows->by_plate.leftCols<3>();
  const VectorXd residual = rows->predicted - sighting.pixels;
  MatrixXd spread = sighting.covariance_with_edges();
  spread += propagated(jacobian, fit.covariance);
  spread += propagated_variances(rows->by_plate.rightCols<3>(), variance.tail<3>());
  const MatrixXd weighed = solve_symmetric(spread, by_shift);
  Disagreement result;
  const Eigen::Matrix3d of_shift = Eigen::Matrix3d(by_shift.transpose() * weighed).inverse();
  result.shift = -(of_shift * Vector3d(weighed.transpose() * residual));
  const Eigen::Matrix3d expected = of_shift + Eigen::Matrix3d(variance.head<3>().asDiagonal());
  result.shift_chi_square = squared_mahalanobis(result.shift, expected);
  const MatrixXd all = spread + propagated_variances(by_shift, variance.head<3>());
  result.chi_square = squared_mahalanobis(residual, all);
  result.degrees_of_freedom = kSightingRows;
  return result;
}

Vector3d position_shift_without(const JointFit& fit, std::size_t index) {
  const PlateRows rows = plate_rows(fit, index);
  return fit.covariance.topRows<3>() * rows.jacobian.transpose() *
         VectorXd(solve_symmetric(rows.left, rows.residual));
}

namespace {

// How a plate's whitened rows change with its place, world axes.
MatrixXd rows_by_shift(const JointProblem& problem, const JointFit& fit,
                       const WhitenedRows::Plate& group) {
  const CalibrationLayout layout = calibration_layout_of_moment(*problem.rig);
  const VehicleFrame frame = vehicle_frame(fit.state.vehicle);
  const auto size = kSightingRows * static_cast<Index>(group.sightings.size());
  MatrixXd by_shift = MatrixXd::Zero(size, 3);
  Index row = 0;
  for (const std::size_t sighting : group.sightings) {
    const auto rows = rows_of(problem, layout, fit.state, frame, problem.sightings[sighting]);
    if (rows) by_shift.middleRows<kSightingRows>(row) = rows->by_plate.leftCols<3>();
    row += kSightingRows;
  }
  group.root.triangularView<Eigen::Lower>().solveInPlace(by_shift);
  return by_shift;
}

}  // namespace

CommonShift common_shift(const JointProblem& problem, const JointFit& fit,
                         std::span<const std::size_t> plates) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Vector3d score = Vector3d::Zero();
  MatrixXd by_parameters = MatrixXd::Zero(fit.covariance.cols(), 3);
  for (const std::size_t index : plates) {
    const WhitenedRows::Plate& group = fit.rows.plates[index];
    const MatrixXd by_shift = rows_by_shift(problem, fit, group);
    information += by_shift.transpose() * by_shift;
    score += by_shift.transpose() * fit.rows.residual.segment(group.begin, by_shift.rows());
    by_parameters +=
        fit.rows.jacobian.middleRows(group.begin, by_shift.rows()).transpose() * by_shift;
  }
  information -= by_parameters.transpose() * fit.covariance * by_parameters;
  CommonShift result;
  result.shift = -solve_symmetric(information, score);
  result.chi_square = -score.dot(result.shift);
  result.moved = -(fit.covariance.topRows<3>() * by_parameters * result.shift);
  return result;
}

Disagreement disagreement_within(const JointProblem& problem, const JointFit& fit,
                                 std::size_t index) {
  const auto [residual, jacobian, left] = plate_rows(fit, index);
  const CommonShift found = common_shift(problem, fit, {&index, 1});
  return {squared_mahalanobis(residual, left), static_cast<int>(residual.size()), found.chi_square,
          found.shift};
}

ParameterDifference greatest_calibration_difference(const JointFit& fit) {
  constexpr double kLeastShare = 1e-4;  // of its variance that the fit removes, to be checked
  ParameterDifference greatest;
  const WhitenedRows& rows = fit.rows;
  const Index count = rows.residual.size() - rows.calibration_begin;
  for (Index i = 0; i < count; ++i) {
    const double weight = rows.jacobian(rows.calibration_begin + i, kVehicleCount + i);
    const double checked =
        1 - weight * weight * fit.covariance(kVehicleCount + i, kVehicleCount + i);
    if (checked < kLeastShare) continue;
    const double sigmas = std::abs(rows.residual[rows.calibration_begin + i]) / std::sqrt(checked);
    if (sigmas > greatest.sigmas) greatest = {static_cast<std::size_t>(i), sigmas};
  }
  return greatest;
}

RangeDifference range_difference(const JointProblem& problem, const JointFit& fit,
                                 std::size_t index) {
  constexpr double kLeastShare = 0.01;  // of the range's variance: with less, the fit knows only it
  const WallRange& range = problem.ranges[index];
  const ObservedWall wall = observe_wall(
      problem.tunnel->centerline, wall_of(*problem.tunnel, range.wall), fit.state.vehicle.position);
  const double residual = range.distance - wall.distance;
  const double own = range.sigma * range.sigma;
  const double of_fit =
      wall.by_position.dot(fit.covariance.topLeftCorner<3, 3>() * wall.by_position);
  if (std::ranges::find(fit.selection.ranges, index) == fit.selection.ranges.end()) {
    return {residual, residual / std::sqrt(own + of_fit)};
  }
  // A fit that uses it moved towards it by of_fit / own of the difference.
  const double left = std::max(own - of_fit, kLeastShare * own);
  return {residual * own / left, residual / std::sqrt(left)};
}

std::optional<Eigen::Matrix<double, 8, 1>> predicted_pixels(const JointProblem& problem,
                                                            const JointState& state,
                                                            std::size_t sighting) {
  const auto rows = rows_of(problem, calibration_layout_of_moment(*problem.rig), state,
                            vehicle_frame(state.vehicle), problem.sightings[sighting]);
  if (!rows) return std::nullopt;
  return rows->predicted;
}

VehicleBudget budget_of(const JointProblem& problem, const JointFit& fit) {
  const WhitenedRows& rows = fit.rows;
  const MatrixXd gain = fit.covariance.topRows(kVehicleCount) * rows.jacobian.transpose();
  const CalibrationLayout layout = calibration_layout_of_moment(*problem.rig);
  const VehicleFrame frame = vehicle_frame(fit.state.vehicle);
  VehicleBudget budget;
  for (const WhitenedRows::Plate& group : rows.plates) {
    const SightedPlate& plate = problem.plates[group.plate];
    // Into pixels: gain / L.
    const auto size = kSightingRows * static_cast<Index>(group.sightings.size());
    const MatrixXd by_pixels = group.root.transpose()
                                   .triangularView<Eigen::Upper>()
                                   .solve(gain.middleCols(group.begin, size).transpose())
                                   .transpose();
    MatrixXd by_plate = MatrixXd::Zero(kVehicleCount, 6);
    Index column = 0;
    for (const std::size_t index : group.sightings) {
      const Sighting& sighting = problem.sightings[index];
      const MatrixXd own = by_pixels.middleCols(column, kSightingRows);
      budget.pixels += propagated(own, sighting.covariance);
      const Eigen::Matrix<double, kVehicleCount, 1> by_edges = own * sighting.by_edges;
      budget.edges += by_edges * by_edges.transpose();
      const auto seen = rows_of(problem, layout, fit.state, frame, sighting);
      if (seen) by_plate += own * MatrixXd(seen->by_plate);
      column += kSightingRows;
    }
    budget.survey += propagated_variances(by_plate, plate.survey_variance);
    budget.coding += propagated_variances(by_plate, plate.coding_variance);
  }
  const auto part = [&](Index begin, Index end) -> VehicleCovariance {
    const MatrixXd own = gain.middleCols(begin, end - begin);
    return own * own.transpose();
  };
  budget.ranges = part(rows.ranges_begin, rows.vehicle_begin);
  budget.vehicle = part(rows.vehicle_begin, rows.calibration_begin);
  budget.calibration = part(rows.calibration_begin, rows.residual.size());
  return budget;
}

}  // namespace tagsmith::detail
