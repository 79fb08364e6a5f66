// SPDX-License-Identifier: Apache-2.0
// A calibration as one web page that needs nothing else.
#pragma once

#include <string>

#include "decoder/cli/calibrate_result.hpp"

namespace tagsmith::detail {

std::string calibration_page(const BoardCalibration& result);

}  // namespace tagsmith::detail
