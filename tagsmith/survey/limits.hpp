// SPDX-License-Identifier: Apache-2.0
// Limits of numbers in files. Internal to tagsmith/survey.
#pragma once

#include <cstddef>

namespace tagsmith::detail {

// ---- Limits of a camera's numbers, wherever they are written.

inline constexpr double kMostPixels = 65'535;   // of an image side
inline constexpr double kLongestFocalPx = 1e7;  // pixels

// ---- Limits of numbers in a survey file.

// Metres: national grids reach 1e7; of tunnel, spacing; of a radius (programs fit arcs that differ
// from a line by millimetres); of a coordinate's standard deviation.
inline constexpr double kFarthest = 1e8;
inline constexpr double kLongest = 1e5;
inline constexpr double kWidestRadius = 1e8;
inline constexpr double kWorstSigma = 0.5;
inline constexpr std::size_t kMostElements = 1'000;

}  // namespace tagsmith::detail
