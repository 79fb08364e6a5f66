// SPDX-License-Identifier: Apache-2.0
// Fixes as JSON lines (docs/formats.md).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/travel.hpp"
#include "decoder/plates/set_aside.hpp"
#include "tagsmith/survey/run.hpp"

namespace tagsmith::detail {

// The budget's parts by their names in JSON and tables.
std::vector<std::pair<std::string, Eigen::Matrix3d>> parts_of(const ErrorBudget& budget);

// `explain` adds the error budget and every corner's residual.
std::string fix_json_line(const Fix& fix, const Measurement& measurement, bool explain);

// What all rows of a run together show.
struct RunFindings {
  RunCheck checked;
  TravelDoubts travel{};
  std::optional<CourseOffset> course{};
  std::optional<RollingShutter> rolling{};
  std::string altered{};        // which photos are exchanged, mirrored or turned; empty = none
  std::string another_drive{};  // why the photos show none of the surveys' tags; empty = they do
};

// The summary of a run by the first method, and of each other under its name; `assumed`: what
// survey and rig do not state (assumptions.hpp); the suspicion is of this rig.
std::string summary_json_line(std::span<const FixSummary> summaries,
                              const std::vector<std::string>& assumed, const RunFindings& findings,
                              const Rig& rig);

}  // namespace tagsmith::detail
