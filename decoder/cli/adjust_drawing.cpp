// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/adjust_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "decoder/cli/magnified.hpp"
#include "tagsmith/render/tunnel_plan.hpp"

namespace tagsmith::detail {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

Colour colour_of(const AsBuiltTag& tag) {
  switch (tag.status) {
    case AsBuiltStatus::control:
      return colours::kGreen;
    case AsBuiltStatus::adjusted:
      return colours::kBlue;
    default:
      return colours::kRed;
  }
}

Matrix2d plane_covariance(const AsBuiltTag& tag) { return tag.covariance.topLeftCorner<2, 2>(); }

double magnification(const Survey& survey, const AsBuiltSurvey& found) {
  std::vector<double> sizes;
  for (const AsBuiltTag& tag : found.tags) {
    if (!tag.has_place()) continue;
    const double ellipse = kEllipse95 * std::sqrt(std::max(0.0, plane_covariance(tag).trace()));
    sizes.push_back(std::max(tag.shift.head<2>().norm(), ellipse));
  }
  return magnification_for(survey.tunnel, std::move(sizes));
}

// On the tunnel's side of the wall: the tag's name is on the other.
void add_height(SketchLayer& layer, const Vector2d& at, Side wall, const AsBuiltTag& tag) {
  const bool is_above = wall == Side::left;  // the drive runs to the right
  layer.add(Words{.text = fmt::format("{:+.1f}", std::round(1e4 * tag.shift.z()) / 10 + 0.0),
                  .at = {at, {0, is_above ? -0.003 : 0.003}},
                  .align = TextAlign::centre,
                  .level = is_above ? TextLevel::top : TextLevel::baseline,
                  .colour = colour_of(tag)});
}

void add_tag(Sketch& sketch, const PlanStrip& strip, const PlacedTag& surveyed,
             const AsBuiltTag& tag, double factor) {
  const Vector2d from = surveyed.world_from_plate.translation.head<2>();
  const Vector2d at = strip.view_from_world * from;
  if (!tag.has_place()) {
    sketch.layer("undetermined").add(Dot{at, 0.002, colours::kRed});
    sketch.layer("undetermined").add(Dot{at, 0.0014, colours::kWhite});
    return;
  }
  const Matrix2d turn = strip.view_from_world.linear();
  const Vector2d to = at + factor * (turn * tag.shift.head<2>());
  Ellipse ellipse = ellipse95(to, turn * plane_covariance(tag) * turn.transpose(), factor);
  ellipse.line.colour = colour_of(tag);
  sketch.layer("ellipses").add(std::move(ellipse));
  sketch.layer("moved").add(Arrow{at, to, {colour_of(tag), kNarrow, {}}, 0.0015});
  add_height(sketch.layer("heights"), at, surveyed.side, tag);
}

DrawingView summary_view(const AsBuiltSurvey& found) {
  const auto count = [&](AsBuiltStatus status) {
    return std::ranges::count(found.tags, status, &AsBuiltTag::status);
  };
  const std::vector<std::string> lines{
      fmt::format("{} tags adjusted (blue), {} control tags (green), {} contradicted (red), {} not "
                  "determined (ring)",
                  count(AsBuiltStatus::adjusted), count(AsBuiltStatus::control),
                  count(AsBuiltStatus::contradicted), count(AsBuiltStatus::undetermined)),
      fmt::format("{} pictures of tags from {} places, {} left out; residuals {:.2f} times what "
                  "was stated",
                  found.sightings, found.stations, found.left_out.size(), found.sigma_factor),
      "numbers: how far the tag hangs above (+) or below (-) its surveyed place, mm"};
  DrawingView view;
  view.title = "As built";
  view.new_row = true;
  add_lines(view.sketch.layer("summary"), lines, 0, colours::kBlack, 0.0025, 0.006);
  return view;
}

}  // namespace

Result<std::vector<Sheet>> draw_as_built(const Survey& survey, const AsBuiltSurvey& found,
                                         Paper paper) {
  const double factor = magnification(survey, found);
  std::vector<DrawingView> views;
  for (const PlanStrip& strip : plan_strips(survey, paper)) {
    DrawingView view = plan_view(survey, strip);
    if (factor != 1) {
      view.title += fmt::format("; arrows and 95 % ellipses magnified {:g} times", factor);
    }
    for (const AsBuiltTag& tag : found.tags) {
      const PlacedTag* surveyed = find_tag(survey, std::string_view(tag.tag));
      if (surveyed == nullptr || surveyed->chainage < strip.from || surveyed->chainage > strip.to) {
        continue;
      }
      add_tag(view.sketch, strip, *surveyed, tag, factor);
    }
    view.new_row = true;
    views.push_back(std::move(view));
  }
  views.push_back(summary_view(found));
  return lay_out_sheets({survey.name, "as built", {}}, views, {paper, coarsest_plan_scale(survey)});
}

}  // namespace tagsmith::detail
