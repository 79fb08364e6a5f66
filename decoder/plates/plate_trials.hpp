// SPDX-License-Identifier: Apache-2.0
// What all plates of a drive, or those of a wall, may have in common that the survey does not say:
// another size, or a turn.
#pragma once

#include <functional>
#include <optional>
#include <span>

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

// A change of plates by `value`, 0 = none: the logarithm of their size, or an angle in radians.
struct PlateTrial {
  RigParameter parameter;
  void (*change)(SightedPlate& plate, double value);
};

// Of each parameter that plates have.
std::span<const PlateTrial> plate_trials();

Drive plates_changed(const PlateTrial& trial, double value, Drive drive);

// The value with which a drive fits best: the best of a grid, then the vertex of a parabola through
// it and its neighbours, which come nearer each time. Nothing where no fit converges, nor where
// none promises a chi-square that is less than that of 0 by `least_gain`.
std::optional<double> best_value(const std::function<double(double)>& chi_square,
                                 double least_gain);

// The survey with its plates turned by this angle; `parameter`: one of their attitudes.
Survey with_turned_plates(Survey survey, RigParameter parameter, double angle);

}  // namespace tagsmith::detail
