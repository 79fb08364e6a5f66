// SPDX-License-Identifier: Apache-2.0
// What a camera's numbers may be, wherever they are written.
#pragma once

namespace tagsmith::detail {

inline constexpr double kMostPixels = 65'535;   // of an image side
inline constexpr double kLongestFocalPx = 1e7;  // pixels

}  // namespace tagsmith::detail
