// SPDX-License-Identifier: Apache-2.0
// Survey files that take over where tags were measured to hang.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"
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

// The entry of `placed` for a tag of the survey that hangs there, in one line of YAML.
std::string placed_entry(const Survey& survey, const AsBuiltPlace& place);

// The survey file's text with these tags in `placed`: their entries changed, or new ones added.
// The printed digits stay what they are, and so do comments and all else. A tag that was placed
// where it was designed, not measured, gets that place as its `design`. `survey`: what the text
// says. Fails where the file is laid out in a way that cannot be changed.
Result<std::string> survey_with_places(std::string_view text, const Survey& survey,
                                       const std::vector<AsBuiltPlace>& places);

}  // namespace tagsmith::detail
