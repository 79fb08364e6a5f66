// SPDX-License-Identifier: Apache-2.0
// What all plates of a drive, or those of a wall, may have in common that the survey does not say:
// another size, a turn, or another point that was measured in place of P.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "decoder/plates/drive_fit.hpp"
#include "tagsmith/tag/measured_point.hpp"

namespace tagsmith::detail {

// What may differ from rig or survey: of a camera, then of the plates of both walls or of one: the
// point that was measured, their size, by how much they rise along the drive, and the survey's
// `tilt`.
enum class RigParameter {
  yaw,
  pitch,
  roll,
  turn,
  focal,
  distortion,
  position,
  plate_point,
  plate_size,
  plate_slope,
  plate_tilt,
  left_plate_tilt,
  right_plate_tilt,
};

// Where a plate hangs if the place that the survey has for its P is that of this point; turned
// against its wall as the survey has it.
Pose plate_measured_at(const MeasuredPoint& point, const Survey& survey, Side side,
                       const Pose& listed);

// Those that plates have and that take any value.
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

// The survey with its plates where they hang if its positions are those of this point.
Survey with_plates_measured_at(Survey survey, const MeasuredPoint& point);

}  // namespace tagsmith::detail
