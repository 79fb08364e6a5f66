// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/report_map.hpp"

#include <utility>

#include "tagsmith/render/tunnel_plan.hpp"

namespace tagsmith::detail {

Colour status_colour(const std::string& status) {
  if (status == "ok") return colours::kGreen;
  if (status == "poor") return colours::kOrange;
  return status == "faulty" ? colours::kRed : colours::kGrey;
}

void add_status_mark(SketchLayer& layer, const SketchPoint& at, const std::string& status) {
  constexpr double kRadius = 0.002;
  const Colour colour = status_colour(status);
  if (status != "faulty") {
    layer.add(Dot{at, kRadius, colour});
    if (status == "unseen") layer.add(Dot{at, 0.6 * kRadius, colours::kWhite});
    return;
  }
  constexpr double kReach = 1.3 * kRadius;
  Area diamond{{}, colour};
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(kReach, 0), Eigen::Vector2d(0, kReach),
                                        Eigen::Vector2d(-kReach, 0), Eigen::Vector2d(0, -kReach)}) {
    diamond.points.emplace_back(at.model, at.paper + corner);
  }
  layer.add(std::move(diamond));
}

std::vector<DrawingView> report_map(const Survey& survey, const VerifyMerge& merged) {
  std::vector<DrawingView> views;
  for (const PlanStrip& strip : plan_strips(survey)) {
    DrawingView view = plan_view(survey, strip);
    view.new_row = true;
    SketchLayer& layer = view.sketch.layer("status");
    for (const PlacedTag& tag : survey.tags) {
      if (tag.chainage < strip.from || tag.chainage > strip.to) continue;
      const Eigen::Vector2d at =
          strip.view_from_world * Eigen::Vector2d(tag.world_from_plate.translation.head<2>());
      add_status_mark(layer, at, status_of(record_of(merged, tag.name)));
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace tagsmith::detail
