// SPDX-License-Identifier: Apache-2.0
// A plan of a drive as a technical drawing: the tunnel with its tags, what the cameras see, how far
// a position is had, and the uncertainty along the chainage.
#pragma once

#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/render/drawing_title.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/render/sketch.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// How well the poses of one chainage are served, as one colour.
enum class Service { both_walls, confirmed, one_tag, some_poses, none };

Service service_of(const DrivePlan& plan, const PlanColumn& column);
Colour colour_of(Service service);

// An example of what each camera shows, a third of the way along `from` to `to`: outlines at the
// camera's height (world frame), as far as tags are usually read first.
std::vector<std::vector<Eigen::Vector3d>> fields_of_view(const Survey& survey, const Rig& rig,
                                                         const DrivePlan& plan, double from,
                                                         double to);

// Sheets with the plan of the tunnel and the profile of the plane's sigma. Fails when there is
// nothing to draw.
Result<std::vector<Sheet>> draw_plan(const Survey& survey, const Rig& rig, const DrivePlan& plan,
                                     Paper paper = Paper::a3);

}  // namespace tagsmith::detail
