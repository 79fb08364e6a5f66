// SPDX-License-Identifier: Apache-2.0
// Morphology of grey levels (Serra 1982).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace tagsmith::detail {

// Closing of values along a line, with a window of `reach` values to either side: a part that is
// darker than all around it and narrower than the window is filled, edges of wider parts stay where
// they are. Beyond its ends the line has no values.
std::vector<float> closed(std::span<const float> values, std::size_t reach);

}  // namespace tagsmith::detail
