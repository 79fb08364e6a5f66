// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tagsmith::detail {

// Metres of a foot: international, and of US surveys (39.37 inches are a metre).
inline constexpr double kFoot = 0.3048;
inline constexpr double kSurveyFoot = 1200.0 / 3937;

}  // namespace tagsmith::detail
