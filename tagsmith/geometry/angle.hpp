// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace tagsmith::detail {

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
constexpr double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

// The same direction within half a turn either way, radians.
inline double wrapped_angle(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

}  // namespace tagsmith::detail
