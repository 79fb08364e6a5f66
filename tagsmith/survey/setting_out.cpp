// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/setting_out.hpp"

#include <algorithm>

namespace tagsmith::detail {

double usual_tolerance(const Survey& survey) {
  constexpr double kTapeAndLevel = 0.005;
  return survey.states_sigma ? std::max(2 * survey.sigma, kTapeAndLevel) : kTapeAndLevel;
}

std::vector<SettingOut> setting_out(const Survey& survey, std::span<const PlacedTag* const> tags,
                                    double tolerance) {
  const Centerline& line = survey.tunnel.centerline;
  std::vector<SettingOut> list;
  for (const PlacedTag* tag : tags) {
    const Eigen::Vector3d& p = tag->world_from_plate.translation;
    const CenterlineAddress address = line.locate(p.head<2>());
    const double floor = line.at(address.chainage).position.z();
    list.push_back({tag, address.chainage, address.offset, p.z() - floor, tolerance});
  }
  return list;
}

}  // namespace tagsmith::detail
