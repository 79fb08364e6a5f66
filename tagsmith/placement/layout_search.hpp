// SPDX-License-Identifier: Apache-2.0
// The search behind `optimise`: what one layout costs and keeps, and how far its plates can be
// spaced.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/placement/layout.hpp"

namespace tagsmith::detail {

// Searches with a coarse plan and proves with the plan as asked for. Keeps references to all it is
// given.
class LayoutSearch {
 public:
  LayoutSearch(const Survey& survey, const Rig& rig, const std::vector<TagTemplate>& templates,
               const Requirement& requirement, CostOrder order, const PlanOptions& options);

  Layout given() const;

  // Which columns can be served at all: the share of them, of the plan as asked for. Fails when
  // none can. To be called before what follows.
  Result<double> find_demanded();
  const std::vector<bool>& demanded() const { return fine_.demanded; }

  // The layout by the plan as asked for.
  LayoutReport report(std::string name, const Layout& layout) const;

  bool is_cheaper(const LayoutReport& a, const LayoutReport& b) const;

  // The layout with the largest spacing that still meets the requirement, and no more pairs than it
  // takes, by the coarse plan. With `best`, only if it may be cheaper than that.
  std::optional<LayoutReport> stretched(const std::string& name, const Layout& layout,
                                        const LayoutReport* best = nullptr) const;

  // Proves what `stretched` found with the plan as asked for; hangs the plates closer while that
  // does not hold.
  LayoutReport proved(const LayoutReport& coarse) const;

  // Layouts that differ from this one in one respect.
  std::vector<Layout> plates(const Layout& layout) const;
  std::vector<Layout> heights(const Layout& layout) const;
  std::vector<Layout> staggers(const Layout& layout) const;
  std::vector<Layout> alphas(const Layout& layout) const;

 private:
  // A plan's options, and which of its columns the requirement is for.
  struct Demand {
    PlanOptions options;
    std::vector<bool> demanded;

    // The first column and each `stride`th after it.
    Demand thinned(std::size_t stride) const;
  };

  Result<DrivePlan> plan_of(const Layout& layout, const PlanOptions& options) const;
  Result<std::vector<bool>> find_demanded(PlanOptions options) const;
  bool meets(const Layout& layout, const Demand& demand) const;
  void judge(const Layout& layout, const Demand& demand, LayoutReport& report) const;
  LayoutReport priced(std::string name, const Layout& layout) const;
  int least_steps(const Layout& layout, const LayoutReport& best) const;
  Layout spaced(Layout layout, int steps) const;
  Layout trimmed(Layout layout) const;
  double up_to() const;
  bool hangs_in_tunnel(const Layout& layout) const;

  const Survey& survey_;
  const Rig& rig_;
  const std::vector<TagTemplate>& templates_;
  const Requirement requirement_;
  const CostOrder order_;
  Demand fine_;
  Demand coarse_;
};

}  // namespace tagsmith::detail
