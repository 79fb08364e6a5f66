// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/survey_drawing.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>

#include "tagsmith/render/sketch_on_paper.hpp"
#include "tagsmith/render/survey_views.hpp"
#include "tagsmith/survey/check_together.hpp"

namespace tagsmith::detail {
namespace {

DrawingPart plan_part(const Survey& survey, Paper paper) {
  return drive_by_strips(survey, paper, [&](const PlanStrip& strip, Side side, bool first) {
    return wall_elevation(survey, strip, side, first);
  });
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

// All of the survey's plan, as the world lies.
PlanStrip whole_as_it_lies(const Survey& survey) {
  const std::vector<PlanStrip> strips = plan_strips(survey);
  return {strips.front().from, strips.back().to, Eigen::Isometry2d::Identity()};
}

void add_all(Sketch& sketch, const Sketch& other) {
  for (const SketchLayer& layer : other.layers) {
    std::vector<SketchItem>& items = sketch.layer(layer.name).items;
    items.insert(items.end(), layer.items.begin(), layer.items.end());
  }
}

void name_drive(Sketch& sketch, const Survey& survey) {
  const CenterlinePoint start = survey.tunnel.centerline.at(0);
  const Eigen::Vector2d at = start.position.head<2>();
  const Eigen::Vector2d along = direction_of(start.heading).head<2>();
  sketch.layer("grid").add(Dot{at, 0.0009, colours::kBlue});
  sketch.layer("grid").add(Arrow{at, {at, 0.012 * along}, {colours::kBlue, kWide, {}}});
  sketch.layer("grid").add(Words{.text = survey.name,
                                 .at = {at, -0.004 * along},
                                 .height = 0.0025,
                                 .align = along.x() > 0 ? TextAlign::right : TextAlign::left,
                                 .level = TextLevel::middle,
                                 .colour = colours::kBlue});
}

}  // namespace

Result<std::vector<Sheet>> draw_together(const std::vector<Survey>& surveys, Paper paper) {
  if (const auto one = check_one_grid(surveys); !one) return fail(one.error().message);
  DrawingView view;
  double coarsest = std::numeric_limits<double>::infinity();
  TitleBlock block{"Drives", "Several surveys in one plan", {}};
  for (const Survey& survey : surveys) {
    add_all(view.sketch, tunnel_plan(survey, whole_as_it_lies(survey)));
    name_drive(view.sketch, survey);
    coarsest = std::min(coarsest, coarsest_plan_scale(survey));
    block.fields.push_back({"Survey", survey.name});
  }
  const Eigen::Vector2d room = drawing_area(paper);
  const Eigen::Vector2d extent = model_extent(view.sketch).value_or(room);
  const double scale = (extent.array() / room.array()).maxCoeff();
  if (scale > coarsest) {
    for (const char* layer : {"names", "centerline"}) {
      std::erase_if(view.sketch.layer(layer).items,
                    [](const SketchItem& item) { return std::holds_alternative<Words>(item); });
    }
  }
  view.title = "All drives from above";
  view.axes = plan_axes(surveys.front(), whole_as_it_lies(surveys.front()));
  const std::vector<DrawingPart> parts{{{std::move(view)}, {.paper = paper}}};
  return lay_out_sheets(block, parts);
}

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

}  // namespace tagsmith::detail
