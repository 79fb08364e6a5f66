// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/travel.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "decoder/localize/joint_method.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"

namespace tagsmith::detail {
namespace {

// Between the median over a run's rows and what is stated: a larger difference is reported. One in
// a hundred correct runs exceeds it, if all rows have the same error.
constexpr double kMostSigmas = 2.5;

bool is_of_use(const Fix& fix) {
  return fix.position_in_grid && fix.covariance_in_grid && fix.attitude && !fix.predicted;
}

double plane_sigma(const Fix& fix) {
  return std::sqrt(fix.covariance_in_grid->topLeftCorner<2, 2>().trace());
}

Eigen::Vector2d step_between(const Fix& from, const Fix& to) {
  return (*to.position_in_grid - *from.position_in_grid).head<2>();
}

constexpr double kShortestStep = 0.5;  // metres

// The steps of half a metre and more from one position to a later one.
std::vector<std::pair<const Fix*, const Fix*>> steps_of(std::span<const Fix> fixes) {
  std::vector<std::pair<const Fix*, const Fix*>> steps;
  const Fix* before = nullptr;
  for (const Fix& fix : fixes) {
    if (!is_of_use(fix)) continue;
    if (before != nullptr) {
      if (step_between(*before, fix).norm() < kShortestStep) continue;
      steps.emplace_back(before, &fix);
    }
    before = &fix;
  }
  return steps;
}

// From the mean of the headings at the ends to the step between them. Along a bend the step's
// direction is between these headings.
double angle_to_step(const Fix& from, const Fix& to) {
  const Eigen::Vector2d step = step_between(from, to);
  const std::complex<double> heading =
      std::polar(1.0, from.attitude->heading) + std::polar(1.0, to.attitude->heading);
  return wrapped_angle(std::atan2(step.x(), step.y()) - std::arg(heading));
}

// A unit number whose argument is twice the angle from the heading to the step, so that forwards
// and backwards are the same. Nothing where the step is too short to determine its direction.
std::optional<std::complex<double>> twice_the_angle(const Fix& from, const Fix& to) {
  const double unsure = radians(3);
  const double length = step_between(from, to).norm();
  if (plane_sigma(from) + plane_sigma(to) > length * std::tan(unsure)) return std::nullopt;
  return std::polar(1.0, 2 * angle_to_step(from, to));
}

// How far the position may be off by a mistake that the measurement does not reveal, metres.
double greatest_unnoticed(const Fix& fix) {
  double greatest = 0;
  for (const Unchecked& mistake : fix.unchecked) greatest = std::max(greatest, mistake.metres);
  return greatest;
}

}  // namespace

std::optional<TurnedHeadings> turned_headings(std::span<const Fix> fixes) {
  constexpr std::size_t kLeastSteps = 5;
  constexpr double kLeastAgreement = 0.9;  // length of the mean: angles within 13 degrees or so
  const double least = radians(20);
  std::complex<double> sum = 0;
  std::size_t steps = 0;
  for (const auto& [from, to] : steps_of(fixes)) {
    if (const auto turned = twice_the_angle(*from, *to)) {
      sum += *turned;
      ++steps;
    }
  }
  const double angle = -std::arg(sum) / 2;
  if (steps < kLeastSteps || std::abs(sum) < kLeastAgreement * static_cast<double>(steps) ||
      std::abs(angle) < least) {
    return std::nullopt;
  }
  return TurnedHeadings{angle, steps};
}

std::optional<CourseOffset> course_offset(std::span<const Fix> fixes) {
  constexpr std::size_t kLeastSteps = 5;
  constexpr double kSurely = 4;    // standard deviations
  constexpr double kRearAxle = 1;  // metres from O, at most
  const double least = radians(0.2);
  std::vector<double> angles, weights, heading_sigmas;
  for (const auto& [from, to] : steps_of(fixes)) {
    const auto twice = twice_the_angle(*from, *to);
    if (!twice || !to->pose_covariance_in_grid) continue;
    const double length = step_between(*from, *to).norm();
    const double bend = wrapped_angle(to->attitude->heading - from->attitude->heading) / length;
    angles.push_back(-std::arg(*twice) / 2);
    heading_sigmas.push_back(std::sqrt((*to->pose_covariance_in_grid)(3, 3)));
    const double noise = std::hypot(plane_sigma(*from), plane_sigma(*to)) / length;
    weights.push_back(1 / std::pow(std::hypot(noise, heading_sigmas.back(), kRearAxle * bend), 2));
  }
  if (angles.size() < kLeastSteps) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(angles.size());
  const Eigen::Map<const Eigen::ArrayXd> angle(angles.data(), count);
  const Eigen::Map<const Eigen::ArrayXd> weight(weights.data(), count);
  const double mean = (weight * angle).sum() / weight.sum();
  const double scatter = (weight * (angle - mean).square()).sum() / static_cast<double>(count - 1);
  const double noise = std::sqrt(std::max(1.0, scatter) / weight.sum());
  const CourseOffset offset{mean, std::hypot(noise, quantile(heading_sigmas, 0.5)), angles.size()};
  const bool is_sure = std::abs(mean) > std::max(least, kSurely * offset.sigma);
  return is_sure && !turned_headings(fixes) ? std::optional(offset) : std::nullopt;
}

std::optional<WrongHeight> wrong_height(std::span<const Fix> fixes,
                                        const std::vector<Survey>& surveys, const Rig& rig) {
  constexpr std::size_t kLeastRows = 3;
  std::vector<double> heights;
  for (const Fix& fix : fixes) {
    if (!is_of_use(fix)) continue;
    const Survey& survey = survey_of(fix, surveys);
    VehiclePose vehicle;
    vehicle.position = world_from_vehicle(fix, survey.grid).translation;
    heights.push_back(observe_stance(survey.tunnel.centerline, vehicle).height_pitch_roll[0]);
  }
  if (heights.size() < kLeastRows) return std::nullopt;
  WrongHeight wrong{quantile(heights, 0.5), rig.vehicle_height};
  wrong.sigmas = std::abs(wrong.height - wrong.stated) / rig.height_sigma;
  return wrong.sigmas >= kMostSigmas ? std::optional(wrong) : std::nullopt;
}

std::optional<WrongRange> wrong_range(std::span<const Fix> fixes, const Rig& rig) {
  constexpr std::size_t kLeastRows = 5;
  for (const RigRange& range : rig.ranges) {
    std::vector<double> metres, sigmas;
    std::size_t explained = 0;
    for (const Fix& fix : fixes) {
      const auto checked = std::ranges::find(fix.checked_ranges, range.name, &CheckedRange::name);
      if (!is_of_use(fix) || checked == fix.checked_ranges.end()) continue;
      metres.push_back(checked->metres);
      sigmas.push_back(checked->sigmas);
      if (std::abs(checked->metres) <= greatest_unnoticed(fix)) ++explained;
    }
    if (metres.size() < kLeastRows) continue;
    WrongRange wrong{range.name, quantile(metres, 0.5), quantile(sigmas, 0.5), metres.size()};
    wrong.tags_may_be_wrong = 2 * explained > wrong.rows;
    const bool on_one_side = quantile(sigmas, 0.25) * quantile(sigmas, 0.75) > 0;
    if (on_one_side && std::abs(wrong.sigmas) >= kMostSigmas) return wrong;
  }
  return std::nullopt;
}

std::string TravelDoubts::why() const {
  if (height) return to_string(*height);
  if (turned) return to_string(*turned);
  return range && range->tags_may_be_wrong ? to_string(*range) : std::string();
}

TravelDoubts travel_doubts(std::span<const Fix> fixes, const std::vector<Survey>& surveys,
                           const Rig& rig) {
  return {turned_headings(fixes), wrong_height(fixes, surveys, rig), wrong_range(fixes, rig)};
}

Fix LiveDoubts::judged(Fix fix, const std::vector<Survey>& surveys, const Rig& rig) {
  constexpr std::size_t kMost = 200;
  if (!is_of_use(fix)) return fix;
  Fix kept;
  kept.survey = fix.survey;
  kept.position_in_grid = fix.position_in_grid;
  kept.covariance_in_grid = fix.covariance_in_grid;
  kept.attitude = fix.attitude;
  kept.checked_ranges = fix.checked_ranges;
  kept.unchecked = fix.unchecked;
  if (last_.size() == kMost) last_.erase(last_.begin());
  last_.push_back(std::move(kept));
  std::string why = travel_doubts(last_, surveys, rig).why();
  return why.empty() ? fix : doubted(std::move(fix), std::move(why));
}

namespace {

// Rows that a rig gives a position.
std::size_t count_located(std::span<const Observation* const> rows,
                          const std::vector<Survey>& surveys, const Rig& rig) {
  return static_cast<std::size_t>(std::ranges::count_if(rows, [&](const Observation* row) {
    return localize_jointly(*row, surveys, rig).position_in_grid.has_value();
  }));
}

// With cameras that may stand and look a little elsewhere.
Rig with_loose_cameras(Rig rig) {
  for (RigCamera& camera : rig.cameras) {
    CalibrationSigma& sigma = camera.calibration_sigma;
    sigma.position = std::max(sigma.position, 0.02);
    sigma.angle = std::max(sigma.angle, radians(0.5));
  }
  return rig;
}

// With rolling shutters of a vehicle that drives 2.5 m/s while 20 ms pass, or less.
Rig with_rolling_shutters(Rig rig) {
  for (RigCamera& camera : rig.cameras) camera.calibration_sigma.shutter = 0.05;
  return rig;
}

}  // namespace

std::optional<RollingShutter> rolling_shutter(std::span<const Fix> fixes,
                                              std::span<const Observation> rows,
                                              const std::vector<Survey>& surveys, const Rig& rig) {
  constexpr std::size_t kLeastRows = 3, kTried = 40;
  constexpr double kLeastShare = 0.7;
  if (has_rolling_shutter(rig)) return std::nullopt;
  std::vector<const Observation*> refused;
  for (std::size_t i = 0; i < fixes.size() && refused.size() < kTried; ++i) {
    if (!fixes[i].position_in_grid && rows[i].tags.size() > 1) refused.push_back(&rows[i]);
  }
  if (refused.size() < kLeastRows) return std::nullopt;
  const RollingShutter rolling{count_located(refused, surveys, with_rolling_shutters(rig)),
                               refused.size()};
  const double least = kLeastShare * static_cast<double>(rolling.rows);
  if (rolling.located < kLeastRows || static_cast<double>(rolling.located) < least) {
    return std::nullopt;
  }
  // What cameras that are mounted a little otherwise explain as well is no shutter.
  if (count_located(refused, surveys, with_loose_cameras(rig)) >= rolling.located) {
    return std::nullopt;
  }
  return rolling;
}

std::string to_string(const RollingShutter& rolling) {
  return fmt::format(
      "{} of {} rows without a position have one when the vehicle may move while the cameras read "
      "the rows of an image one after another. If they do (rolling shutters), stop for photos, or "
      "state `readout` of each camera, which is not 0, and `speed` of the envelope in the rig; "
      "else survey or rig are wrong",
      rolling.located, rolling.rows);
}

std::string to_string(const WrongRange& wrong) {
  return fmt::format(
      "range {} is {:.3f} m {} than the tags say, on the median of {} rows ({:.1f} standard "
      "deviations): {}the place of the range sensor, what it measures or the wall's place in the "
      "survey is wrong",
      wrong.name, std::abs(wrong.metres), wrong.metres > 0 ? "longer" : "shorter", wrong.rows,
      std::abs(wrong.sigmas),
      wrong.tags_may_be_wrong ? "the focal length of a camera, the size of the plates, " : "");
}

std::string to_string(const WrongHeight& wrong) {
  return fmt::format(
      "the vehicle stands {:.3f} m above the floor on the median of the rows, and the rig says "
      "{:.3f} m ({:.1f} standard deviations): the rig's vehicle.height or cameras are wrong, all "
      "plates hang higher or lower than surveyed, or the photos are mirrored top to bottom",
      wrong.height, wrong.stated, wrong.sigmas);
}

std::string to_string(const TurnedHeadings& turned) {
  return fmt::format(
      "the headings are turned by {:.0f} degrees to the {} of the way that the vehicle went, in {} "
      "steps: a camera looks elsewhere than the rig says, or its photos are another camera's",
      std::abs(degrees(turned.angle)), turned.angle > 0 ? "right" : "left", turned.steps);
}

std::string to_string(const CourseOffset& offset) {
  return fmt::format(
      "the headings are turned by {:.2f} +-{:.2f} degrees to the {} of the way that the vehicle "
      "went, in {} steps: unless it was not driven from place to place, all cameras are turned on "
      "it by as much, and headings are off by that; calibrate their mounting on the vehicle",
      std::abs(degrees(offset.angle)), degrees(offset.sigma), offset.angle > 0 ? "right" : "left",
      offset.steps);
}

}  // namespace tagsmith::detail
