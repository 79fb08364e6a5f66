// SPDX-License-Identifier: Apache-2.0
// Single points of a list that lie far from all others: nearly always a mistyped coordinate.
#pragma once

#include <functional>
#include <vector>

#include "tagsmith/draft/fit_tunnel.hpp"
#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/survey/finding_log.hpp"

namespace tagsmith::detail {

using FitOfPoints = std::function<Result<TunnelFit>(std::vector<SurveyedPoint>)>;

// Logs an error for each of up to three points that have no other point within three times the
// usual step of the list and two metres, where the others fit a tunnel (`fit`) and this one lies
// beside it, above it, below it, or further beyond its end than it is long. A fit of all points
// would follow such a point, or accuse others.
void check_far_points(const std::vector<SurveyedPoint>& points, const Grid& grid,
                      const FitOfPoints& fit, FindingLog& log);

}  // namespace tagsmith::detail
