// SPDX-License-Identifier: Apache-2.0
// What a drive shows of its plates: the input of the adjustment of hung plates.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "decoder/localize/sighting_model.hpp"
#include "tagsmith/survey/rig.hpp"

namespace tagsmith::detail {

// What is known of a vehicle's pose besides what its cameras see.
struct VehiclePrior {
  VehiclePose mean;
  // In the order of vehicle_parameter, metres and radians; infinite = nothing is known.
  Eigen::Matrix<double, 6, 1> sigma =
      Eigen::Matrix<double, 6, 1>::Constant(std::numeric_limits<double>::infinity());
};

// What a rig's cameras saw at one moment, from one place.
struct Station {
  std::string name;
  std::vector<Sighting> sightings;
  std::optional<VehiclePrior> prior{};
  bool is_backward = false;  // the vehicle points against the center line's direction
};

// The rig must outlive the problem. A plate's survey_variance says how far it may hang from its
// surveyed place.
struct AdjustmentProblem {
  const Rig* rig = nullptr;
  std::vector<SightedPlate> plates;
  std::vector<Station> stations;
  double frame_sigma = 0;  // relative, of the size that all frames have in common; 0 = exact
  // Which parameters of the cameras are uncertain; nothing = as the rig's sigmas say.
  std::optional<CalibrationLayout> calibration{};
  // Plates, by index, whose common shift is wanted, from everything but their own surveyed places.
  std::vector<std::vector<std::size_t>> groups{};
  // Places of the survey whose plates no picture shows: a second copy of another plate may hang
  // there.
  std::vector<SightedPlate> unseen{};
};

// What is not taken from the survey and the template of a plate.
enum class PlateFreedom {
  none,   // it hangs as surveyed, within the survey's variance
  size,   // it hangs as surveyed, and its frame is of any size about its middle
  place,  // it hangs anywhere
  any,    // it hangs anywhere and is of any size
};

}  // namespace tagsmith::detail
