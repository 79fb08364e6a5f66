// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/settled_fit.hpp"

#include <algorithm>

#include <Eigen/Core>

namespace tagsmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// The fit's rows, derived by the calibration at its pose: ranges and stance do not depend on it.
MatrixXd by_calibration(const JointProblem& problem, const CalibrationLayout& layout,
                        const JointFit& fit) {
  const VehicleFrame frame = vehicle_frame(fit.state.vehicle);
  MatrixXd derived =
      MatrixXd::Zero(fit.rows.residual.size(), static_cast<Index>(layout.sigmas.size()));
  for (const WhitenedRows::Plate& group : fit.rows.plates) {
    Index row = group.begin;
    for (const std::size_t index : group.sightings) {
      const Sighting& sighting = problem.sightings[index];
      const auto rows = sighting_rows(*problem.rig, layout, {}, frame,
                                      problem.plates[sighting.plate], sighting.camera);
      for (std::size_t i = 0; rows && i < kCalibrationCount; ++i) {
        const int place = layout.places[sighting.camera][i];
        if (place < 0) continue;
        derived.col(place).segment<kSightingRows>(row) =
            rows->by_calibration.col(static_cast<Index>(i));
      }
      row += kSightingRows;
    }
    group.root.triangularView<Eigen::Lower>().solveInPlace(
        derived.middleRows(group.begin, row - group.begin));
  }
  return derived;
}

}  // namespace

SettledFit settled(const JointProblem& problem, const JointFit& fit) {
  constexpr double kBorneOut = 3.1;  // once in a thousand
  SettledFit own{fit.state, fit.vehicle_covariance(), budget_of(problem, fit), fit.chi_square,
                 fit.degrees_of_freedom};
  const CalibrationLayout layout = calibration_layout(*problem.rig);
  const auto is_exact = [](const Sighting& sighting) { return sighting.by_edges.isZero(); };
  if (layout.sigmas.empty() && std::ranges::all_of(problem.sightings, is_exact)) return own;
  Rig as_said = *problem.rig;
  for (RigCamera& camera : as_said.cameras) camera.calibration_sigma = {};
  JointProblem exact = problem;
  exact.rig = &as_said;
  exact.edges_weigh = false;
  const auto said = fit_jointly(exact, fit.selection, fit.state.vehicle);
  if (!said || said->chi_square > chi_square_limit(said->degrees_of_freedom, kBorneOut)) return own;
  SettledFit result{said->state, said->vehicle_covariance(), budget_of(exact, *said),
                    said->chi_square, said->degrees_of_freedom};
  const Eigen::Map<const Eigen::VectorXd> sigmas(layout.sigmas.data(),
                                                 static_cast<Index>(layout.sigmas.size()));
  const MatrixXd moved = said->covariance * said->rows.jacobian.transpose() *
                         by_calibration(problem, layout, *said) * sigmas.asDiagonal();
  result.budget.calibration = moved * moved.transpose();
  result.covariance = total(result.budget);
  return result;
}

}  // namespace tagsmith
