// SPDX-License-Identifier: Apache-2.0
// Pictures of a calibration: coverage, residuals, distortion.
#pragma once

#include <string>
#include <vector>

#include "decoder/cli/calibrate_result.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {

// The three pictures and the results in words, on one sheet. Fails as lay_out_sheets does.
Result<std::vector<Sheet>> draw_calibration(const BoardCalibration& result);

// ---- A calibration as one web page without further files.

std::string calibration_page(const BoardCalibration& result);

}  // namespace tagsmith::detail
