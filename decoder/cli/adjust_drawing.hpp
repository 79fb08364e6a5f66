// SPDX-License-Identifier: Apache-2.0
// How far the tags hang from their surveyed places, as a technical drawing.
#pragma once

#include <vector>

#include "decoder/verify/as_built.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/render/sheet_layout.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The tunnel's plan with an arrow for each tag from where it was surveyed to where it hangs, its
// 95 % ellipse, and how far it hangs above (+) or below (-), millimetres. Control tags are green:
// their arrows are residuals. Tags without a place have a ring. Arrows and ellipses are magnified
// by one round factor, which the drawing says; the plan itself is to scale.
Result<std::vector<Sheet>> draw_as_built(const Survey& survey, const AsBuiltSurvey& found,
                                         Paper paper = Paper::a3);

}  // namespace tagsmith::detail
