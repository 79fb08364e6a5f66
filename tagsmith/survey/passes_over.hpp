// SPDX-License-Identifier: Apache-2.0
// Drives that pass over or under themselves, as spiral ramps do. Places in a tunnel are found by
// their plan, which such a drive has twice.
#pragma once

#include <cstddef>
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

// The first place along a way at which it comes within `reach` of itself, seen from above, more
// than `room` higher or lower. Bends narrower than that are not taken for one.
std::optional<Passing> passing_of(const std::vector<Eigen::Vector3d>& way, double reach,
                                  double room);

}  // namespace tagsmith::detail
