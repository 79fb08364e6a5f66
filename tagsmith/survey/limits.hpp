// SPDX-License-Identifier: Apache-2.0
// What numbers in files may be at most. Internal to tagsmith/survey.
#pragma once

#include <cstddef>

namespace tagsmith::detail {

// ---- What a camera's numbers may be, wherever they are written.

inline constexpr double kMostPixels = 65'535;   // of an image side
inline constexpr double kLongestFocalPx = 1e7;  // pixels

// ---- What numbers of a survey file may be at most.

// Metres: national grids reach 1e7; of tunnel, spacing; of a radius (programs fit arcs that differ
// from a line by millimetres); of a coordinate's standard deviation.
inline constexpr double kFarthest = 1e8;
inline constexpr double kLongest = 1e5;
inline constexpr double kWidestRadius = 1e8;
inline constexpr double kWorstSigma = 0.5;
inline constexpr std::size_t kMostElements = 1'000;

}  // namespace tagsmith::detail
