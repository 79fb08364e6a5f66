// SPDX-License-Identifier: Apache-2.0
// The JSON lines of `calibrate` from photos of boards (docs/formats.md).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "decoder/cli/calibrate_result.hpp"

namespace tagsmith::detail {

// A line a photo, each with its line end.
std::string calibration_photo_lines(const BoardCalibration& result);

// Without its line end; `written` are the files that were.
std::string calibration_summary_line(const BoardCalibration& result,
                                     const std::vector<std::string>& written);

// The summary where the photos make no camera at all.
std::string no_calibration_line(std::size_t photos, const std::string& reason);

}  // namespace tagsmith::detail
