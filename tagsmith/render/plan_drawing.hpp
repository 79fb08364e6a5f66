// SPDX-License-Identifier: Apache-2.0
// A plan of a drive as a technical drawing: the tunnel with its tags, what the cameras see, where a
// position is available, and the uncertainty along the chainage.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
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

// How a service is shown.
struct ServiceStyle {
  const char* key;    // in JSON
  const char* words;  // of a legend
  Colour colour;
};

// In the order of Service.
inline constexpr std::array kServiceStyles{
    ServiceStyle{"both", "both walls, every pose", colours::kGreen},
    ServiceStyle{"confirmed", "two tags, one whole", {0.45, 0.70, 0.20}},
    ServiceStyle{"one", "a tag, every pose", {0.80, 0.80, 0.25}},
    ServiceStyle{"some", "some poses have none", colours::kOrange},
    ServiceStyle{"none", "no tag", colours::kRed},
};
static_assert(kServiceStyles.size() == static_cast<std::size_t>(Service::none) + 1);

inline const ServiceStyle& style_of(Service service) {
  return kServiceStyles[static_cast<std::size_t>(service)];
}

// Columns of a plan that are served alike; `last`: where the next run begins, or the last column.
struct ServiceRun {
  std::size_t first = 0;
  std::size_t last = 0;
  Service service = Service::none;
};

// The runs of columns within [from, to], chainages.
std::vector<ServiceRun> service_runs(const DrivePlan& plan,
                                     double from = -std::numeric_limits<double>::infinity(),
                                     double to = std::numeric_limits<double>::infinity());

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
