// SPDX-License-Identifier: Apache-2.0
// The fix by everything measured, as it is in the tunnel of one survey.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// As the tags of the survey `home` are named, and SURVEY/TAG for those of another.
std::string name_of(const PlacedTag& tag, std::size_t survey, std::size_t home,
                    const std::vector<Survey>& surveys);

// As localize_jointly, by the tags of the observation alone, parts among them that are taken for
// certain tags; those of all surveys, for they are in one grid (check_one_grid). The tunnel is that
// of the survey `home`.
Fix localize_by_tags(const Observation& observation, const std::vector<Survey>& surveys,
                     std::size_t home, const Rig& rig);

}  // namespace tagsmith::detail
