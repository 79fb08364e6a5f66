// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace tagsmith::detail {

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
constexpr double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

}  // namespace tagsmith::detail
