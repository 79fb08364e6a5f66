// SPDX-License-Identifier: Apache-2.0
// What all plates of a drive, or those of a wall, may have in common that the survey does not say:
// another size, or a turn.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "decoder/plates/drive_fit.hpp"

namespace tagsmith::detail {

// What may differ from rig or survey: of a camera, then of the plates of both walls or of one:
// their size, by how much they rise along the drive, and the survey's `tilt`.
enum class RigParameter {
  yaw,
  pitch,
  roll,
  turn,
  focal,
  position,
  plate_size,
  plate_slope,
  plate_tilt,
  left_plate_tilt,
  right_plate_tilt,
};

// Those that plates have.
inline constexpr std::array kCommonToPlates{RigParameter::plate_size, RigParameter::plate_slope,
                                            RigParameter::plate_tilt, RigParameter::left_plate_tilt,
                                            RigParameter::right_plate_tilt};

// The plate on this wall turned by an angle (radians) of `parameter`; as it is where that does not
// turn it.
Pose turned_plate(const Pose& plate, Side side, RigParameter parameter, double angle);

// The drive with its plates changed by `value`, 0 = none: the logarithm of their size, or an angle.
Drive plates_changed(RigParameter parameter, double value, Drive drive);

// The value with which a drive fits best: the best of a grid, then the vertex of a parabola through
// it and its neighbours, which come nearer each time. Nothing where no fit converges, nor where
// none promises a chi-square that is less than that of 0 by `least_gain`.
std::optional<double> best_value(const std::function<double(double)>& chi_square,
                                 double least_gain);

// The survey with its plates turned by this angle; `parameter`: one of their attitudes.
Survey with_turned_plates(Survey survey, RigParameter parameter, double angle);

}  // namespace tagsmith::detail
