// SPDX-License-Identifier: Apache-2.0
// The part of `tagsmith plan` that looks for a better layout and writes it down.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/placement/optimise.hpp"

namespace tagsmith::detail {

struct OptimiseOptions {
  Requirement requirement;
  CostOrder order = CostOrder::tags;
  std::vector<std::string> vary{"height", "plate", "stagger", "alpha"};
};

// A file that the chosen layout makes: the survey, the rig where alpha changed, and the template
// where it is not one of the tool's own.
struct LayoutFile {
  std::string name;
  std::string bytes;
};

// The chosen layout as files, with what was read back from them: what is planned next is what was
// written.
struct OptimisedDrive {
  Optimisation optimisation;
  std::vector<LayoutFile> files;
  Survey survey;
  Rig rig;
};

Result<OptimisedDrive> optimise_drive(const Survey& survey, const Rig& rig,
                                      const OptimiseOptions& options, const PlanOptions& plan);

// The alternatives, a line each, the chosen one marked.
std::string optimisation_report(const Optimisation& optimisation, const OptimiseOptions& options);

// One JSON object (docs/formats.md).
std::string optimisation_json(const Optimisation& optimisation);

}  // namespace tagsmith::detail
