// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/layout.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "tagsmith/survey/place_tags.hpp"

namespace tagsmith::detail {

bool all_look_aside(const Rig& rig) {
  return std::ranges::all_of(rig.cameras,
                             [](const RigCamera& camera) { return camera.side.has_value(); });
}

bool is_same(const Layout& a, const Layout& b) {
  return a.tag_template.name == b.tag_template.name && a.series.spacing == b.series.spacing &&
         a.series.mount_height == b.series.mount_height && a.series.pairs == b.series.pairs &&
         a.series.pair_angle == b.series.pair_angle && a.alpha == b.alpha;
}

bool is_served(const PlanColumn& column, const Requirement& requirement) {
  return column.least_tags > requirement.tags_lost &&
         column.worst.plane <= requirement.plane_sigma &&
         (requirement.tags_lost == 0 || column.nominal_one_lost <= requirement.plane_sigma);
}

double served_share(const DrivePlan& plan, const Requirement& requirement,
                    const std::vector<bool>& demanded) {
  int wanted = 0;
  int met = 0;
  for (std::size_t i = 0; i < plan.columns.size(); ++i) {
    if (!demanded.at(i)) continue;
    ++wanted;
    met += is_served(plan.columns[i], requirement) ? 1 : 0;
  }
  return wanted > 0 ? static_cast<double>(met) / wanted : 1;
}

Survey with_layout(const Survey& survey, const Layout& layout) {
  Survey changed = survey;
  changed.tag_template = layout.tag_template;
  changed.series = layout.series;
  changed.tags.clear();
  for (int pair = 0; pair < layout.series.pairs; ++pair) {
    changed.tags.push_back(place_in_series(changed, pair, Side::left));
    changed.tags.push_back(place_in_series(changed, pair, Side::right));
  }
  return changed;
}

Rig with_alpha(const Rig& rig, std::optional<double> alpha) {
  Rig changed = rig;
  if (!alpha) return changed;
  for (RigCamera& camera : changed.cameras) {
    const Eigen::Vector3d axis = camera.vehicle_from_camera.rotation.col(2);
    const Eigen::Vector3d wanted =
        vehicle_from_side_camera(camera.side.value(), *alpha).rotation.col(2);
    const double turn = std::atan2(wanted.y(), wanted.x()) - std::atan2(axis.y(), axis.x());
    camera.vehicle_from_camera.rotation =
        Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * camera.vehicle_from_camera.rotation;
  }
  return changed;
}

}  // namespace tagsmith::detail
