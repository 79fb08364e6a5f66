// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace tagsmith::detail {

// By how much residuals that are alike in neighbouring places raise a fit's variance: what they
// have in common up to the first distance at which they have nothing. 1 for independent ones.
double correlation_factor(std::span<const float> residuals);

}  // namespace tagsmith::detail
