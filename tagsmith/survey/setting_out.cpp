// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/setting_out.hpp"

#include <algorithm>

namespace tagsmith::detail {

double height_of_p(const Survey& survey, const PlacedTag& tag) {
  return tag.world_from_plate.translation.z() -
         survey.tunnel.centerline.at(tag.chainage).position.z();
}

double offset_of_p(const Survey& survey, const PlacedTag& tag) {
  return survey.tunnel.centerline.locate(tag.world_from_plate.translation.head<2>()).offset;
}

double usual_tolerance(const Survey& survey) {
  constexpr double kTapeAndLevel = 0.005;
  return survey.states_sigma ? std::max(2 * survey.sigma, kTapeAndLevel) : kTapeAndLevel;
}

std::vector<SettingOut> setting_out(const Survey& survey, std::span<const PlacedTag* const> tags,
                                    double tolerance) {
  std::vector<SettingOut> list;
  for (const PlacedTag* tag : tags) {
    list.push_back(
        {tag, tag->chainage, offset_of_p(survey, *tag), height_of_p(survey, *tag), tolerance});
  }
  return list;
}

}  // namespace tagsmith::detail
