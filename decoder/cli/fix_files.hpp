// SPDX-License-Identifier: Apache-2.0
// A run's fixes as files for other programs.
#pragma once

#include <string>
#include <vector>

#include "decoder/localize/fix.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

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
