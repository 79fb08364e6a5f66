// SPDX-License-Identifier: Apache-2.0
// What the cameras saw in each row of a run.
#pragma once

#include <vector>

#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Reads the images of all rows, several at the same time, with a progress bar. Pictures that occur
// in rows of several times are left out. The surveys must outlive the result.
std::vector<Observation> observe_run(const Run& run, const std::vector<Survey>& surveys,
                                     const Rig& rig, const ReaderChoice& reader, int jobs);

}  // namespace tagsmith::detail
