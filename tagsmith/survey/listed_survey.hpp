// SPDX-License-Identifier: Apache-2.0
// The values that all tags of a list by `tagsmith export` share.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

struct ListedSurvey {
  std::string tag_template;
  // Length and height of the plate, and inner ones of its frame, metres; lists of older versions do
  // not have them.
  std::optional<std::array<double, 4>> plate;
  // Of the plates' attitudes, radians, where the list states it.
  std::optional<double> angle_sigma{};
  PositionCode code;
  Grid grid;
};

// The code under which LandXML (a Feature) and GSI (blocks 41) have it.
inline constexpr const char* kListedSurvey = "TAGSMITH";

// As a list says it.
inline std::array<double, 4> listed_plate(const TagTemplate& tag) {
  return {tag.plate_length, tag.plate_height, tag.frame_inner_length, tag.frame_inner_height};
}

}  // namespace tagsmith::detail
