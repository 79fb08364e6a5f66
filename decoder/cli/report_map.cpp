// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/report_map.hpp"

#include "tagsmith/render/tunnel_plan.hpp"

namespace tagsmith {

Colour status_colour(const std::string& status) {
  if (status == "ok") return colours::kGreen;
  if (status == "poor") return colours::kOrange;
  return status == "faulty" ? colours::kRed : colours::kGrey;
}

std::vector<DrawingView> report_map(const Survey& survey, const VerifyMerge& merged) {
  constexpr double kRadius = 0.0022;
  std::vector<DrawingView> views;
  for (const PlanStrip& strip : plan_strips(survey)) {
    DrawingView view = plan_view(survey, strip);
    view.new_row = true;
    SketchLayer& layer = view.sketch.layer("status");
    for (const PlacedTag& tag : survey.tags) {
      if (tag.chainage < strip.from || tag.chainage > strip.to) continue;
      const Eigen::Vector2d at =
          strip.view_from_world * Eigen::Vector2d(tag.world_from_plate.translation.head<2>());
      layer.add(Dot{at, kRadius, status_colour(status_of(record_of(merged, tag.name)))});
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace tagsmith
