// SPDX-License-Identifier: Apache-2.0
// Tags that a rig can never see.
#pragma once

#include <cstddef>
#include <vector>

#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Indices in survey.tags of those that no camera of the rig sees completely and large enough to be
// read standing still with the survey as code book, wherever on the center line the vehicle is
// (every quarter metre) and however far its envelope lets it stray: middle and edges, turned and
// tilted or not. The vehicle drives along the drive, not against it. Takes linear time in the
// number of tags.
std::vector<std::size_t> unseen_tags(const Survey& survey, const Rig& rig);

}  // namespace tagsmith::detail
