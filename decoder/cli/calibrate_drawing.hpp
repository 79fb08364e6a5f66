// SPDX-License-Identifier: Apache-2.0
// Pictures of a calibration: coverage, residuals, distortion.
#pragma once

#include <string>
#include <vector>

#include "decoder/cli/calibrate_result.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet.hpp"
#include "tagsmith/render/sheet_layout.hpp"

namespace tagsmith::detail {

// The three pictures, in paper's size: the image with its ray sigmas and the corners seen; the
// residuals as arrows; the distortion along the radius, and below it, magnified, its standard
// deviation and how the runner-up differs.
std::vector<DrawingView> calibration_views(const BoardCalibration& result);

// These and the results in words, on one sheet. Fails as lay_out_sheets does.
Result<std::vector<Sheet>> draw_calibration(const BoardCalibration& result);

// ---- A calibration as one web page without further files.

std::string calibration_page(const BoardCalibration& result);

}  // namespace tagsmith::detail
