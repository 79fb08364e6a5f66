// SPDX-License-Identifier: Apache-2.0
// Slips in lists of surveyed points that a fit would explain badly, or not detect.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tagsmith/draft/fit_tunnel.hpp"
#include "tagsmith/draft/point_list.hpp"
#include "tagsmith/survey/finding_log.hpp"

namespace tagsmith::detail {

// Logs an error for each point that lies far from all others, and among them with its x and y
// exchanged. Of fewer than five points nothing is said.
void check_exchanged(const std::vector<SurveyedPoint>& points, FindingLog& log);

// Where numbers read as metres make walls that no drive has: further apart than 12, nearer than
// 0.5, or both walls and roof 7.5 apart (three metres in feet, which few drives reach in metres).
// In words, of the file's numbers, with the remedy; nothing where they may be metres.
std::optional<std::string> doubt_of_unit(const std::vector<SurveyedPoint>& points,
                                         double metres_per_unit);

// Logs a warning for each point whose height disagrees with the line through the six nearest of
// its kind along the drive, by more than eight times the scatter of that kind and 30 mm. Tags of
// both walls are one kind where a wall has fewer than seven. Of kinds with fewer than seven points
// nothing is said.
void check_heights(const std::vector<SurveyedPoint>& points, const TunnelFit& fit, FindingLog& log);

// The same across the tunnel: for each point that lies further from where it was fitted than eight
// times the scatter of the other tags, walls or center line (of all where these are fewer than
// seven), and 3 mm. Points that were not fitted are not judged.
void check_across(const std::vector<SurveyedPoint>& points, const TunnelFit& fit, FindingLog& log);

}  // namespace tagsmith::detail
