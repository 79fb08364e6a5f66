// SPDX-License-Identifier: Apache-2.0
// The cheapest layout of the regular tags that meets a requirement along the whole drive.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// ---- How the regular tags may hang, and the cost and the result of that.

// What every pose of every demanded column must have.
struct Requirement {
  double plane_sigma = 0.02;  // at most, metres
  int tags_lost = 0;          // 0 or 1: this many unreadable tags may not leave a pose without one
};

enum class CostOrder {
  tags,   // fewest tags, then the least plate area
  plate,  // the smallest plate, then the fewest tags
};

// The regular tags and, where it was changed, the angle by which the side cameras look forward.
struct Layout {
  TagTemplate tag_template;
  TagSeries series;
  std::optional<double> alpha;  // radians; absent = as the rig says
};

// The cost and the result of a layout.
struct LayoutReport {
  std::string name;  // what was changed, for people
  Layout layout;
  int tags = 0;
  double plate_area = 0;     // of all plates, square metres
  bool meets = false;        // the requirement, at every demanded column
  double met_share = 0;      // of the demanded columns
  double covered_share = 0;  // of all columns: every pose has a position
  double worst_plane = 0;    // sigma over all poses that have a position; infinite without any
};

bool is_same(const Layout& a, const Layout& b);

// True when every camera has a side, so that an alpha can be given to it.
bool all_look_aside(const Rig& rig);

bool is_served(const PlanColumn& column, const Requirement& requirement);

// The share of the demanded columns that meet the requirement; 1 when none is demanded.
double served_share(const DrivePlan& plan, const Requirement& requirement,
                    const std::vector<bool>& demanded);

// The survey with this layout of its regular tags; digits are left empty.
Survey with_layout(const Survey& survey, const Layout& layout);
// The rig with its side cameras turned about the vertical to look so far forward.
Rig with_alpha(const Rig& rig, std::optional<double> alpha);

// ---- The search.

// What the search may change. The spacing always varies.
struct Freedom {
  bool mount_height = true;
  bool plate = true;
  bool stagger = true;
  bool alpha = true;
};

struct Optimisation {
  LayoutReport given;
  LayoutReport chosen;  // the given one where no other is cheaper
  // The spacing alone, each freedom with it, then all freedoms together.
  std::vector<LayoutReport> alternatives;
  bool alpha_can_vary = false;  // see all_look_aside
  double demanded_share = 0;    // of the columns, those that are demanded
  std::vector<bool> demanded;   // by column of the plan as asked for
};

// Called as the search goes on: searches done of all.
using SearchProgress = std::function<void(std::size_t done, std::size_t total)>;

// Searches the plan's stretch and speed, coarsely; the chosen layout and the given one are then
// planned with `options` unchanged. Demanded are the columns that the given layout serves or plates
// hung as densely as possible would. Fails for surveys without a regular series or with as-built
// tags, when nothing at all can be demanded, and when no layout meets the requirement.
Result<Optimisation> optimise(const Survey& survey, const Rig& rig,
                              const std::vector<TagTemplate>& templates,
                              const Requirement& requirement, CostOrder order,
                              const Freedom& freedom, const PlanOptions& options,
                              const SearchProgress& progress = {});

}  // namespace tagsmith::detail
