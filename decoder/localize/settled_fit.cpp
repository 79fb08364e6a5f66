// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/settled_fit.hpp"

#include <algorithm>

#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {

SettledFit settled(const JointProblem& problem, const JointFit& fit) {
  constexpr double kBorneOut = 3.1;  // of a normal value: once in a thousand
  SettledFit result{fit.state, fit.vehicle_covariance(), budget_of(problem, fit), fit.chi_square,
                    fit.degrees_of_freedom};
  const auto is_exact = [](const Sighting& sighting) { return sighting.by_edges.isZero(); };
  if (fit.state.calibration.size() == 0 && std::ranges::all_of(problem.sightings, is_exact)) {
    return result;
  }
  Rig as_said = *problem.rig;
  for (RigCamera& camera : as_said.cameras) camera.calibration_sigma = {};
  JointProblem exact = problem;
  exact.rig = &as_said;
  exact.edges_weigh = false;
  const auto said = fit_jointly(exact, fit.selection, fit.state.vehicle);
  if (!said || said->chi_square > chi_square_limit(said->degrees_of_freedom, kBorneOut)) {
    return result;
  }
  const Eigen::Matrix<double, 6, 1> apart = pose_difference(fit.state.vehicle, said->state.vehicle);
  const VehicleCovariance square = apart * apart.transpose();
  result.covariance += square;
  result.budget.calibration += square;
  result.state = said->state;
  result.chi_square = said->chi_square;
  result.degrees_of_freedom = said->degrees_of_freedom;
  return result;
}

}  // namespace tagsmith::detail
