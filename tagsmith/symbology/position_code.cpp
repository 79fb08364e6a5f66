// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/symbology/position_code.hpp"

#include <cmath>
#include <cstdint>

namespace tagsmith::detail {
namespace {

std::int64_t unit_count(int digit_count) {
  std::int64_t count = 1;
  for (int i = 0; i < digit_count; ++i) count *= 10;
  return count;
}

// The coordinate in units of the last digit. The nudge lets 0.345 m at 0.01 m round up although
// its nearest double lies below the half.
double units_of(const PositionCode& code, std::size_t axis, double coordinate) {
  constexpr double kNudge = 1e-6;
  return std::floor((coordinate - code.origin[axis]) / code.resolution[axis] + 0.5 + kNudge);
}

}  // namespace

std::array<double, 2> coded_range(const PositionCode& code, int axis) {
  const auto i = static_cast<std::size_t>(axis);
  const auto greatest = static_cast<double>(unit_count(code.digit_counts[i]) - 1);
  return {code.origin[i], code.origin[i] + greatest * code.resolution[i]};
}

std::optional<int> axis_out_of_range(const PositionCode& code, const GridPoint& position) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double units = units_of(code, axis, position[axis]);
    const auto limit = static_cast<double>(unit_count(code.digit_counts[axis]));
    if (!(units >= 0 && units < limit)) return static_cast<int>(axis);
  }
  return std::nullopt;
}

std::optional<EncodedPosition> encode_position(const PositionCode& code,
                                               const GridPoint& position) {
  if (axis_out_of_range(code, position)) return std::nullopt;
  EncodedPosition encoded;
  std::size_t end = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double units = units_of(code, axis, position[axis]);
    encoded.rounding[axis] = code.origin[axis] + units * code.resolution[axis] - position[axis];
    auto rest = static_cast<std::int64_t>(units);
    end += static_cast<std::size_t>(code.digit_counts[axis]);
    for (int i = 0; i < code.digit_counts[axis]; ++i) {
      encoded.digits[end - 1 - static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(rest % 10);
      rest /= 10;
    }
  }
  encoded.digits.back() = check_digit(code.check, std::span(encoded.digits).first<11>());
  return encoded;
}

GridPoint decode_position(const PositionCode& code, const Digits& digits) {
  GridPoint position{};
  std::size_t next = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::int64_t units = 0;
    for (int i = 0; i < code.digit_counts[axis]; ++i) units = units * 10 + digits[next++];
    position[axis] = code.origin[axis] + static_cast<double>(units) * code.resolution[axis];
  }
  return position;
}

}  // namespace tagsmith::detail
