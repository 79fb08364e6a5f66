// SPDX-License-Identifier: Apache-2.0
// Fixes as JSON lines (docs/formats.md), and a run's fixes as files for other programs.
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
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// ---- JSON lines.

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

// ---- Files.

// A table with a row for each measurement (RFC 4180, lines end with LF), as docs/formats.md says.
// `fixes[i]` belongs to `measurements[i]`.
std::string fixes_csv(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements);

// A trajectory as the TUM benchmark writes it (Sturm et al. 2012, "A benchmark for the evaluation
// of RGB-D SLAM systems"): `time x y z qx qy qz qw` of world_from_vehicle, vehicle x forward, y
// left, z up. Quaternions cannot mirror: of a grid with x to the left, x is written with the
// opposite sign, as the first line says. Measurements without a position or attitude are left out.
// Fails, naming the row, when one that is located has no time, and when nothing is left to write.
Result<std::string> fixes_tum(const std::vector<Fix>& fixes, const Run& run,
                              const std::vector<Survey>& surveys);

}  // namespace tagsmith::detail
