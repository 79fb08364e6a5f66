// SPDX-License-Identifier: Apache-2.0
// Drives that pass over or under themselves, as spiral ramps do. Places in a tunnel are found by
// their plan, which such a drive has twice.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tagsmith::detail {

// Where a way comes over or under an earlier part of itself: corners of the way near the place.
struct Passing {
  std::size_t earlier = 0;
  std::size_t later = 0;
  double above = 0;  // how far the later part lies above the earlier one, metres
};

// How far apart, seen from above, the drives at two corners of the way are no longer one over the
// other: the earlier corner and the later one.
using ReachBetween = std::function<double(std::size_t, std::size_t)>;

// The first place along a way, looked at every `step` metres, at which it comes within reach of
// itself, seen from above, more than `room` higher or lower. Bends narrower than that are not taken
// for one. No reach exceeds `greatest_reach`.
std::optional<Passing> passing_of(const std::vector<Eigen::Vector3d>& way, double step, double room,
                                  double greatest_reach, const ReachBetween& reach_between);

}  // namespace tagsmith::detail
