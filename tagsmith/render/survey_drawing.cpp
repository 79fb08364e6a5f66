// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/survey_drawing.hpp"

#include <utility>

#include "tagsmith/render/survey_views.hpp"

namespace tagsmith {
namespace {

DrawingPart plan_part(const Survey& survey, Paper paper) {
  const PlanStyle style{paper, false};
  DrawingPart part{{}, {paper, coarsest_plan_scale(survey)}};
  bool first = true;
  for (const PlanStrip& strip : plan_strips(survey, style)) {
    part.views.push_back(annotated_plan(survey, strip, style, first));
    part.views.push_back(wall_elevation(survey, strip, Side::left, first));
    part.views.push_back(wall_elevation(survey, strip, Side::right, first));
    first = false;
  }
  return part;
}

DrawingPart detail_part(const Survey& survey, const std::optional<Rig>& rig, Paper paper) {
  DrawingPart part{{}, {.paper = paper}};
  const std::optional<TagPair> pair = first_pair(survey);
  if (!survey.tags.empty()) {
    part.views.push_back(cross_section(survey, pair ? pair->left : survey.tags.front(), rig));
  }
  if (pair) part.views.push_back(pair_plan(survey, *pair));
  if (rig) part.views.push_back(rig_view(survey, *rig));
  if (!survey.tags.empty()) part.views.push_back(plate_view(survey, survey.tags.front()));
  part.views.push_back(survey_notes(survey, rig));
  return part;
}

}  // namespace

Result<std::vector<Sheet>> draw_survey(const Survey& survey, const std::optional<Rig>& rig,
                                       const SurveyDrawingStyle& style) {
  TitleBlock block{survey.name, "What the survey means", {}};
  block.fields.push_back({"Survey", survey.file.filename().string()});
  if (!style.revision.empty()) block.fields.push_back({"Revision", style.revision});
  block.fields.push_back({"Template", survey.tag_template.name});
  if (rig) block.fields.push_back({"Rig", rig->name});
  std::vector<DrawingPart> parts{plan_part(survey, style.paper),
                                 detail_part(survey, rig, style.paper)};
  if (!survey.tags.empty() && survey.tags.size() <= kMostListedTags) {
    parts.push_back({tag_tables(survey, style.paper), {.paper = style.paper}});
  }
  return lay_out_sheets(block, parts);
}

}  // namespace tagsmith
