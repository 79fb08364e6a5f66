// SPDX-License-Identifier: Apache-2.0
// The section `placed` of a survey file. Internal to tagsmith/survey.
#pragma once

#include <map>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/yaml_reader.hpp"

namespace tagsmith::detail {

// An entry of `placed` as written.
struct PlacedEntry {
  TagName name;
  Eigen::Vector3d p_in_grid = Eigen::Vector3d::Zero();
  std::optional<Digits> digits;
  std::optional<double> sigma;
  std::string date;
  std::optional<Eigen::Vector3d> design_in_grid;
  bool control = false;
  std::optional<PlateAttitude> attitude;
  Place place;
};

using TagKey = std::pair<int, Side>;

// The entries without a fault; faults are logged. `check` is the scheme of printed digits, nothing
// when it is not known.
std::map<TagKey, PlacedEntry> read_placed(const YamlNode* node,
                                          const std::optional<CheckDigit>& check, FindingLog& log);

}  // namespace tagsmith::detail
