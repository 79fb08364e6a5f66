// SPDX-License-Identifier: Apache-2.0
// The cheapest layout of the regular tags that keeps a promise along the whole drive.
#pragma once

#include <functional>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/placement/drive_plan.hpp"
#include "tagsmith/placement/layout.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

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

// Search at the plan's stretch and speed, coarsely; the chosen layout and the given one are then
// planned with `options` as they are. Demanded are the columns that the given layout serves or
// plates hung as densely as possible would. Fails for surveys without a regular series or with
// as-built tags, when nothing at all can be demanded, and when no layout meets the requirement.
Result<Optimisation> optimise(const Survey& survey, const Rig& rig,
                              const std::vector<TagTemplate>& templates,
                              const Requirement& requirement, CostOrder order,
                              const Freedom& freedom, const PlanOptions& options,
                              const SearchProgress& progress = {});

}  // namespace tagsmith::detail
