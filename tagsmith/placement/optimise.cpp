// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/placement/optimise.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/placement/layout_search.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kRounds = 2;  // over all freedoms

// A freedom: layouts that differ from a given one in it.
struct Step {
  bool allowed = true;
  const char* name = "";
  std::vector<Layout> (LayoutSearch::*layouts)(const Layout&) const = nullptr;
};

std::vector<Step> allowed_steps(const Freedom& freedom) {
  std::vector<Step> steps{
      {freedom.plate, "plate and spacing", &LayoutSearch::plates},
      {freedom.mount_height, "height and spacing", &LayoutSearch::heights},
      {freedom.stagger, "stagger and spacing", &LayoutSearch::staggers},
      {freedom.alpha, "alpha and spacing", &LayoutSearch::alphas},
  };
  std::erase_if(steps, [](const Step& step) { return !step.allowed; });
  return steps;
}

// The spacing alone, each freedom with it, then all of them in turn from the best of these.
std::vector<LayoutReport> explore(const LayoutSearch& search, const std::vector<Step>& steps,
                                  const SearchProgress& progress) {
  std::size_t total = 0;
  for (const Step& step : steps) {
    total += (1 + kRounds) * std::invoke(step.layouts, search, search.given()).size();
  }
  std::size_t done = 0;
  const auto best_of = [&](const std::string& name, const LayoutReport& from, const Step& step) {
    LayoutReport best = from;
    for (const Layout& layout : std::invoke(step.layouts, search, from.layout)) {
      if (progress) progress(done++, total);
      auto tried = search.stretched(name, layout, &best);
      if (tried && search.is_cheaper(*tried, best)) best = std::move(*tried);
    }
    best.name = name;
    return best;
  };
  const LayoutReport spacing = *search.stretched("spacing", search.given());
  LayoutReport together = spacing;
  std::vector<LayoutReport> found{spacing};
  for (const Step& step : steps) {
    found.push_back(best_of(step.name, spacing, step));
    if (search.is_cheaper(found.back(), together)) together = found.back();
  }
  for (std::size_t round = 0; round < kRounds; ++round) {
    for (const Step& step : steps) together = best_of("all together", together, step);
  }
  together.name = "all together";
  if (steps.size() > 1) found.push_back(together);
  return found;
}

// What was found, by the plan as asked for.
std::vector<LayoutReport> prove(const LayoutSearch& search,
                                const std::vector<LayoutReport>& found) {
  std::vector<LayoutReport> proved;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto same = std::ranges::find_if(found, [&](const LayoutReport& earlier) {
      return is_same(earlier.layout, found[i].layout);
    });
    const auto first = static_cast<std::size_t>(same - found.begin());
    proved.push_back(first < i ? proved[first] : search.proved(found[i]));
    proved.back().name = found[i].name;
  }
  return proved;
}

Result<void> check(const Survey& survey) {
  if (!survey.series) {
    return fail(survey.file.string() +
                ": has no regular tags (spacing, first, pairs), expected some: placed tags hang "
                "where they hang");
  }
  const bool as_built = std::ranges::any_of(survey.tags, &PlacedTag::surveyed);
  if (as_built) {
    return fail(survey.file.string() +
                ": has tags under `placed`, expected regular ones only: tags that hang already are "
                "not moved");
  }
  return {};
}

}  // namespace

Result<Optimisation> optimise(const Survey& survey, const Rig& rig,
                              const std::vector<TagTemplate>& templates,
                              const Requirement& requirement, CostOrder order,
                              const Freedom& freedom, const PlanOptions& options,
                              const SearchProgress& progress) {
  if (auto good = check(survey); !good) return fail(good.error().message);
  LayoutSearch search(survey, rig, templates, requirement, order, options);
  const Result<double> demanded_share = search.find_demanded();
  if (!demanded_share) return fail(demanded_share.error().message);
  Optimisation result;
  result.demanded_share = *demanded_share;
  result.demanded = search.demanded();
  result.alpha_can_vary = all_look_aside(rig);
  result.given = search.report("as given", search.given());
  result.alternatives = prove(search, explore(search, allowed_steps(freedom), progress));
  result.chosen = result.given;
  for (const LayoutReport& alternative : result.alternatives) {
    if (search.is_cheaper(alternative, result.chosen)) result.chosen = alternative;
  }
  if (result.chosen.meets) return result;
  return fail(fmt::format(
      "{} with {}: no layout meets the requirement ({} mm in the plane at every pose, {} tags "
      "lost): the best found ({}, {} m apart, {} mm at the worst pose) meets it along {:.1f} % of "
      "the drive that can be served; ask for less, or change the cameras",
      survey.file.string(), rig.file.string(), format_number(1000 * requirement.plane_sigma, 3),
      requirement.tags_lost, result.chosen.name,
      format_number(result.chosen.layout.series.spacing, 2),
      format_number(1000 * result.chosen.worst_plane, 1), 100 * result.chosen.met_share));
}

}  // namespace tagsmith::detail
