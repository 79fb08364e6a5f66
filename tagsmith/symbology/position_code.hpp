// SPDX-License-Identifier: Apache-2.0
// The eleven payload digits as a position: some digits for x, for y and for z of the tag's corner P
// (Xu et al. 2017, "Barcode tag design": 4, 4 and 3).
#pragma once

#include <array>
#include <optional>

#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// Grid coordinates x, y, z in metres.
using GridPoint = std::array<double, 3>;

// How positions become digits. Valid when the digit counts are positive and sum to 11 and the
// resolutions are positive.
struct PositionCode {
  CheckDigit check = CheckDigit::gs1;
  std::array<int, 3> digit_counts{4, 4, 3};
  GridPoint resolution{0.01, 0.01, 0.01};  // metres of one unit of the last digit
  GridPoint origin{0, 0, 0};  // subtracted before coding: nothing negative can be coded
};

// What became of a position.
struct EncodedPosition {
  Digits digits{};
  GridPoint rounding{};  // coded minus true, metres; at most half a resolution
};

// The range [origin, greatest codable coordinate] of an axis (0, 1, 2), metres.
std::array<double, 2> coded_range(const PositionCode& code, int axis);

// The axis (0, 1, 2) on which the position cannot be coded, nothing when it can.
std::optional<int> axis_out_of_range(const PositionCode& code, const GridPoint& position);

// Nothing when the position is out of range or not finite. Halves round up.
std::optional<EncodedPosition> encode_position(const PositionCode& code, const GridPoint& position);

// The coded position, the check digit apart.
GridPoint decode_position(const PositionCode& code, const Digits& digits);

}  // namespace tagsmith::detail
