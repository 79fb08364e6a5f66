// SPDX-License-Identifier: Apache-2.0
// The measured place of a tag, and its entry in a survey file's section `placed`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Where a tag hangs as measured.
struct AsBuiltPlace {
  std::string tag;  // of the survey
  Eigen::Vector3d p_in_grid = Eigen::Vector3d::Zero();
  PlateAttitude attitude;
  double sigma = 0;  // of a coordinate of P, metres
  std::string date;  // of the measurement, as 2026-03-31; empty = it is left out
};

// Keys of an entry of `placed` and their values, as YAML.
using PlacedKeys = std::vector<std::pair<std::string, std::string>>;

// In fixed notation; a value that rounds to zero is written without its sign.
std::string rounded_text(double value, int decimals);

// A point, to a tenth of a millimetre.
std::string point_text(const Eigen::Vector3d& p);

// The measured part of the entry.
PlacedKeys measured_keys(const AsBuiltPlace& place);

// `digits` of the entry.
std::string digits_text(const PlacedTag& tag);

// The entry of `placed` for a tag of the survey that hangs there, in one line of YAML.
std::string placed_entry(const Survey& survey, const AsBuiltPlace& place);

}  // namespace tagsmith::detail
