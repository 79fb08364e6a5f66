// SPDX-License-Identifier: Apache-2.0
// A located run as a technical drawing.
#pragma once

#include <vector>

#include "decoder/localize/fix.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The tunnel's plan where the run went, with the truth, each fix, its 95 % ellipse and its error
// (after Figs 17, 20 and 21 of Xu et al. 2017); a chart of the errors; their means, 95 % and
// greatest values beside the paper's. Errors and ellipses, which are millimetres in a tunnel of
// metres, are drawn magnified by one round factor, which the drawing states; the plan itself is to
// scale. `fixes[i]` belongs to `run.measurements[i]`. Fixes of other surveys are left out.
Result<std::vector<Sheet>> draw_run(const Survey& survey, const Rig& rig, const Run& run,
                                    const std::vector<Fix>& fixes);

}  // namespace tagsmith::detail
