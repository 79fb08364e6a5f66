// SPDX-License-Identifier: Apache-2.0
// A plan as one web page without further files: answers, map and profile.
#pragma once

#include <string>

#include "tagsmith/cli/plan_report.hpp"

namespace tagsmith::detail {

// HTML with its styles, data and script inside; opens without a network, on a phone as well.
std::string plan_page(const PlannedDrive& drive);

}  // namespace tagsmith::detail
