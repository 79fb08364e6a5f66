// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/plate_trials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

namespace tagsmith::detail {
namespace {

// `value`: the logarithm of the plates' size.
void resize(SightedPlate& plate, double value) {
  plate.length *= std::exp(value);
  plate.height *= std::exp(value);
}

void turn(SightedPlate& plate, double angle, const Eigen::Vector3d& axis) {
  plate.world_from_plate.rotation *= Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// Plates of both walls rise along the drive by this angle.
void follow_slope(SightedPlate& plate, double value) {
  turn(plate, plate.side == Side::left ? -value : value, Eigen::Vector3d::UnitZ());
}

// The upper edge forward, as the survey's `tilt`.
void tilt(SightedPlate& plate, double value) { turn(plate, value, Eigen::Vector3d::UnitX()); }

template <Side side>
void tilt_of_wall(SightedPlate& plate, double value) {
  if (plate.side == side) tilt(plate, value);
}

constexpr std::array<PlateTrial, 5> kPlateTrials{{
    {RigParameter::plate_size, resize},
    {RigParameter::plate_slope, follow_slope},
    {RigParameter::plate_tilt, tilt},
    {RigParameter::left_plate_tilt, tilt_of_wall<Side::left>},
    {RigParameter::right_plate_tilt, tilt_of_wall<Side::right>},
}};

}  // namespace

std::span<const PlateTrial> plate_trials() { return kPlateTrials; }

Drive plates_changed(const PlateTrial& trial, double value, Drive drive) {
  for (SightedPlate& plate : drive.plates) trial.change(plate, value);
  return drive;
}

std::optional<double> best_value(const std::function<double(double)>& chi_square,
                                 double least_gain) {
  constexpr double kStep = 0.05;
  constexpr int kSteps = 8;  // to each side: sizes of two thirds to one and a half, 23 degrees
  double best = 0;
  for (const double way : {-kStep, kStep}) {
    int worse = 0;  // one after another: twice, and the minimum is behind
    for (int step = 1; step <= kSteps && worse < 2; ++step) {
      const double here = chi_square(step * way);
      if (!std::isfinite(here)) continue;
      worse = here < chi_square((step - 1) * way) ? 0 : worse + 1;
      if (here < chi_square(best)) best = step * way;
    }
  }
  if (best == 0) {
    const double before = chi_square(-kStep), after = chi_square(kStep);
    const double bend = before + after - 2 * chi_square(0);
    if (std::pow(before - after, 2) < 8 * bend * least_gain) return std::nullopt;
  }
  double step = kStep;
  for (int round = 0; round < 4; ++round, step /= 5) {
    const double before = chi_square(best - step), after = chi_square(best + step);
    const double bend = before + after - 2 * chi_square(best);
    const double vertex = best + std::clamp((before - after) / bend / 2, -1.0, 1.0) * step;
    for (const double tried : {best - step, best + step, vertex}) {
      if (std::isfinite(tried) && chi_square(tried) < chi_square(best)) best = tried;
    }
  }
  return std::isfinite(chi_square(best)) ? std::optional(best) : std::nullopt;
}

Survey with_turned_plates(Survey survey, RigParameter parameter, double angle) {
  const auto trial = std::ranges::find(kPlateTrials, parameter, &PlateTrial::parameter);
  for (PlacedTag& tag : survey.tags) {
    SightedPlate plate{tag.name, tag.side, tag.world_from_plate};
    trial->change(plate, angle);
    tag.world_from_plate = plate.world_from_plate;
  }
  return survey;
}

}  // namespace tagsmith::detail
