// SPDX-License-Identifier: Apache-2.0
// Whether a list of surveyed points runs along the drive.
#pragma once

#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/point_list.hpp"

namespace tagsmith::detail {

// Fails where the points of one kind run back by metres, and names the points of which one alone
// explains it: mostly two digits of a coordinate were exchanged. A fit would bend the tunnel
// through such a point. Points with chainages and named tags may come in any order, and those of
// floor and roof need not run along the drive.
Result<void> check_order(const std::vector<SurveyedPoint>& points);

}  // namespace tagsmith::detail
