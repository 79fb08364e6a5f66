// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/plate_trials.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace tagsmith::detail {
namespace {

Pose turned(Pose plate, double angle, const Eigen::Vector3d& axis) {
  plate.rotation *= Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  return plate;
}

}  // namespace

Pose plate_measured_at(const MeasuredPoint& point, const Survey& survey, Side side,
                       const Pose& listed) {
  constexpr int kRounds = 4;  // where walls bend
  const auto wall_at = [&](const Eigen::Vector3d& p) {
    return plate_on_wall(survey.tunnel, survey.tag_template, side, p).rotation;
  };
  const Eigen::Matrix3d against_wall = wall_at(listed.translation).transpose() * listed.rotation;
  Pose plate = listed;
  for (int round = 0; round < kRounds; ++round) {
    plate.translation = listed.translation -
                        plate.rotation.leftCols<2>() * Eigen::Vector2d(point.right, point.down);
    plate.rotation = wall_at(plate.translation) * against_wall;
  }
  return plate;
}

Pose turned_plate(const Pose& plate, Side side, RigParameter parameter, double angle) {
  const bool on_left = side == Side::left;
  switch (parameter) {
    case RigParameter::plate_slope:
      return turned(plate, on_left ? -angle : angle, Eigen::Vector3d::UnitZ());
    case RigParameter::plate_tilt:
      return turned(plate, angle, Eigen::Vector3d::UnitX());
    case RigParameter::left_plate_tilt:
      return on_left ? turned(plate, angle, Eigen::Vector3d::UnitX()) : plate;
    case RigParameter::right_plate_tilt:
      return on_left ? plate : turned(plate, angle, Eigen::Vector3d::UnitX());
    default:
      return plate;
  }
}

Drive plates_changed(RigParameter parameter, double value, Drive drive) {
  for (SightedPlate& plate : drive.plates) {
    if (parameter == RigParameter::plate_size) {
      plate.length *= std::exp(value);
      plate.height *= std::exp(value);
    }
    plate.world_from_plate = turned_plate(plate.world_from_plate, plate.side, parameter, value);
  }
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
  for (PlacedTag& tag : survey.tags) {
    tag.world_from_plate = turned_plate(tag.world_from_plate, tag.side, parameter, angle);
  }
  return survey;
}

Survey with_plates_measured_at(Survey survey, const MeasuredPoint& point) {
  for (PlacedTag& tag : survey.tags) {
    tag.world_from_plate = plate_measured_at(point, survey, tag.side, tag.world_from_plate);
    tag.p_in_grid = grid_from_world(survey.grid, tag.world_from_plate.translation);
  }
  return survey;
}

}  // namespace tagsmith::detail
