// SPDX-License-Identifier: Apache-2.0
// The drawing "what this file means", so that surveyor and engineer see the same before anything is
// printed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/drawing_title.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Tags listed in the drawing's table at most; a longer table is for `tagsmith export`.
inline constexpr std::size_t kMostListedTags = 2'000;

struct SurveyDrawingStyle {
  Paper paper = Paper::a3;
  std::string revision;  // of the survey, for the title block; empty = none is shown
};

// Plan and wall elevations by strips; the details: cross section, a pair with theta and stagger, a
// plate with P, the rig, the conventions in words; the table of tags. Fails as lay_out_sheets does.
Result<std::vector<Sheet>> draw_survey(const Survey& survey, const std::optional<Rig>& rig,
                                       const SurveyDrawingStyle& style = {});

// Several drives of one grid in one plan, +y up the sheet: tunnels, plates, the begin of each
// drive. Names of tags where the scale leaves space for them. Fails when the grids differ in
// handedness, and as lay_out_sheets does.
Result<std::vector<Sheet>> draw_together(const std::vector<Survey>& surveys, Paper paper);

}  // namespace tagsmith::detail
