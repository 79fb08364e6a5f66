// SPDX-License-Identifier: Apache-2.0
// Runs in which the photos of two cameras are exchanged.
#pragma once

#include <string>
#include <vector>

#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Where three rows and seven in ten of those that show tags in two cameras fit a place of the
// vehicle once these cameras' photos are exchanged, and at most half as many do as stated: removes
// what the two cameras show from all rows, which then say why. Rows of a long run are sampled
// evenly. Returns what is wrong; empty where nothing is.
std::string leave_out_exchanged(std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                                const Rig& rig);

}  // namespace tagsmith::detail
