// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/fix.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace tagsmith {

std::string status_of(const Fix& fix) { return fix.position_in_grid ? "ok" : "no_position"; }

std::optional<FixError> error_of(const Fix& fix, const Measurement& measurement) {
  if (!fix.position_in_grid || !measurement.truth_in_grid) return std::nullopt;
  const Eigen::Vector3d error = *fix.position_in_grid - *measurement.truth_in_grid;
  return FixError{std::hypot(error.x(), error.y()), std::abs(error.z())};
}

FixSummary summarize(const std::vector<Fix>& fixes, const std::vector<Measurement>& measurements) {
  assert(fixes.size() == measurements.size());
  FixSummary summary;
  FixError sum;
  FixError greatest;
  int errors = 0;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    ++summary.count;
    if (fixes[i].position_in_grid) ++summary.located;
    const std::optional<FixError> error = error_of(fixes[i], measurements[i]);
    if (!error) continue;
    ++errors;
    sum.plane += error->plane;
    sum.height += error->height;
    greatest.plane = std::max(greatest.plane, error->plane);
    greatest.height = std::max(greatest.height, error->height);
  }
  if (errors > 0) {
    summary.mean_error = FixError{sum.plane / errors, sum.height / errors};
    summary.max_error = greatest;
  }
  return summary;
}

}  // namespace tagsmith
