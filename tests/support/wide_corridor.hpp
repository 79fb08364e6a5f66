// SPDX-License-Identifier: Apache-2.0
// The shipped corridor with a rig that sees both walls, and plates that may hang elsewhere.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "tagsmith/geometry/pose.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail::test {

struct WideCorridor {
  Survey survey = load_survey("surveys/corridor/survey.yaml").value();
  Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  std::vector<Pose> hung;  // where the plates truly hang

  WideCorridor() {
    for (RigCamera& camera : rig.cameras) camera.camera.fx = camera.camera.fy = 800;
    for (const PlacedTag& tag : survey.tags) hung.push_back(tag.world_from_plate);
  }

  std::size_t index(std::string_view name) const {
    return static_cast<std::size_t>(find_tag(survey, name) - survey.tags.data());
  }
};

}  // namespace tagsmith::detail::test
