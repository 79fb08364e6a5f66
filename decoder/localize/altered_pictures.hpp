// SPDX-License-Identifier: Apache-2.0
// Runs in which the photos of two cameras are exchanged, or photos are mirrored or turned.
#pragma once

#include <string>
#include <vector>

#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Where three rows and seven in ten of those that can tell fit a place of the vehicle once two
// cameras' photos are exchanged, or the photos of all cameras or of one are mirrored back or turned
// by 180 degrees, and at most half as many do as stated: removes what these cameras show from all
// rows, which then say why. Rows of a long run are sampled evenly. Returns what is wrong; empty
// where nothing is.
std::string leave_out_altered(std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                              const Rig& rig);

}  // namespace tagsmith::detail
