// SPDX-License-Identifier: Apache-2.0
// Where an adjustment of plates starts: vehicles placed by the plates that hang as surveyed, freed
// plates by those vehicles.
#pragma once

#include <optional>
#include <vector>

#include "decoder/plates/adjustment_problem.hpp"

namespace tagsmith::detail {

bool hangs_anywhere(PlateFreedom freedom);

struct AdjustmentStart {
  std::vector<Pose> world_from_plate;
  std::vector<std::optional<VehiclePose>> vehicles;  // by station; none where it cannot be placed
};

// Vehicles from the plates that hang as surveyed, freed plates from those vehicles, and so on.
// `freed`, one a plate. A plate that no placed vehicle shows starts where it was surveyed.
AdjustmentStart start_of(const AdjustmentProblem& problem, const std::vector<PlateFreedom>& freed);

// How far the corners of b are from where a's picture predicts them when both hang as surveyed, in
// frame diagonals of b; with the better of the poses that a allows. Infinite when a allows none.
double mismatch(const AdjustmentProblem& problem, const Sighting& a, const Sighting& b);

}  // namespace tagsmith::detail
