// SPDX-License-Identifier: Apache-2.0
// Whether the headings of a run point the way that the vehicle went.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "decoder/localize/fix.hpp"

namespace tagsmith::detail {

// How far the headings are turned from the way between positions.
struct TurnedHeadings {
  double angle = 0;       // radians, -pi/2 to pi/2, positive to the right
  std::size_t steps = 0;  // from a position to the next that were compared
};

// A vehicle goes forwards or backwards, not sideways: where nearly all of five steps and more lie
// at one and the same angle of over 20 degrees to its heading, a camera looks elsewhere than the
// rig says, or its photos are another camera's. Steps of half a metre and more that the positions'
// errors cannot turn by more than 3 degrees count. Nothing where headings fit, where the steps do
// not agree, and where fewer than five count.
std::optional<TurnedHeadings> turned_headings(std::span<const Fix> fixes);

// "the headings are turned by ... degrees from the way between the positions ..."
std::string to_string(const TurnedHeadings& turned);

}  // namespace tagsmith::detail
