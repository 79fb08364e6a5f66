// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/observe_run.hpp"

#include <cstddef>

#include "decoder/localize/repeated_pictures.hpp"
#include "tagsmith/cli/parallel.hpp"

namespace tagsmith::detail {

std::vector<Observation> observe_run(const Run& run, const std::vector<Survey>& surveys,
                                     const Rig& rig, const ReaderChoice& reader, int jobs) {
  std::vector<Observation> rows(run.measurements.size());
  run_below_bar(
      "measurements", rows.size(), jobs,
      [&](std::size_t i) { return observe(run.measurements[i], surveys, rig, reader); },
      [&](std::size_t i, Observation& seen) { rows[i] = std::move(seen); });
  leave_out_repeated(rows);
  return rows;
}

}  // namespace tagsmith::detail
