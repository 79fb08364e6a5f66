// SPDX-License-Identifier: Apache-2.0
// Whether surveyed points agree with their neighbours along the drive.
#pragma once

#include <cstddef>
#include <vector>

#include "tagsmith/base/result.hpp"
#include "tagsmith/draft/point_list.hpp"

namespace tagsmith::detail {

// ---- Heights along a drive against those of their neighbours. Internal to tagsmith/survey.

inline constexpr std::size_t kNeighboursBeside = 3;  // on either side, as far as there are any

struct HeightStation {
  double chainage = 0;  // metres, as all
  double height = 0;
  std::size_t index = 0;  // of the point
};

// How far a station lies above the height that its neighbours say.
struct NeighbourOff {
  double off = 0;
  // How much less sure that height is than amid the neighbours: a line is worth the less the
  // farther it is prolonged.
  double uncertainty = 1;
};

// Of each station against the line (Theil and Sen: the median slope of all pairs, but of those that
// are too near each other to have one) through its six neighbours, of which one or two may be
// wrong; at the ends that line is prolonged. `stations` are in the order of their chainages.
// Nothing for fewer than seven.
std::vector<NeighbourOff> offs_from_neighbours(const std::vector<HeightStation>& stations);

// ---- Helpers of fits and checks. Internal to tagsmith/survey.

// Of values among which some are slips, one standard deviation.
double scatter_of(std::vector<double> values);

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b);

// ---- Whether a list of surveyed points runs along the drive.

// Fails where the points of one kind run back by metres, and names the points of which one alone
// explains it: usually two digits of a coordinate were exchanged. A fit would bend the tunnel
// through such a point. Points with chainages and named tags may come in any order, and those of
// floor and roof need not run along the drive. Fails, too, where a drive passes over itself.
Result<void> check_order(const std::vector<SurveyedPoint>& points);

}  // namespace tagsmith::detail
