// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/travel.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Core>
#include <fmt/format.h>

#include "tagsmith/base/quantile.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"

namespace tagsmith::detail {
namespace {

double plane_sigma(const Fix& fix) {
  return std::sqrt(fix.covariance_in_grid->topLeftCorner<2, 2>().trace());
}

// A unit number whose argument is twice the angle from the heading to the step, so that forwards
// and backwards are one. Nothing where the step does not tell its direction.
std::optional<std::complex<double>> twice_the_angle(const Fix& from, const Fix& to) {
  constexpr double kShortest = 0.5;  // metres
  const double unsure = radians(3);
  const Eigen::Vector2d step = (*to.position_in_grid - *from.position_in_grid).head<2>();
  const double length = step.norm();
  if (length < kShortest || plane_sigma(from) + plane_sigma(to) > length * std::tan(unsure)) {
    return std::nullopt;
  }
  const double direction = std::atan2(step.x(), step.y());
  // Along a bend the step's direction is between the headings at its ends.
  const std::complex<double> heading =
      std::polar(1.0, from.attitude->heading) + std::polar(1.0, to.attitude->heading);
  return std::polar(1.0, 2 * (direction - std::arg(heading)));
}

bool is_of_use(const Fix& fix) {
  return fix.position_in_grid && fix.covariance_in_grid && fix.attitude && !fix.predicted;
}

}  // namespace

std::optional<TurnedHeadings> turned_headings(std::span<const Fix> fixes) {
  constexpr std::size_t kLeastSteps = 5;
  constexpr double kLeastAgreement = 0.9;  // length of the mean: angles within 13 degrees or so
  const double least = radians(20);
  std::complex<double> sum = 0;
  std::size_t steps = 0;
  const Fix* before = nullptr;
  for (const Fix& fix : fixes) {
    if (!is_of_use(fix)) continue;
    if (before != nullptr && before->survey == fix.survey) {
      if (const auto turned = twice_the_angle(*before, fix)) {
        sum += *turned;
        ++steps;
      }
    }
    before = &fix;
  }
  const double angle = -std::arg(sum) / 2;
  if (steps < kLeastSteps || std::abs(sum) < kLeastAgreement * static_cast<double>(steps) ||
      std::abs(angle) < least) {
    return std::nullopt;
  }
  return TurnedHeadings{angle, steps};
}

std::optional<WrongHeight> wrong_height(std::span<const Fix> fixes,
                                        const std::vector<Survey>& surveys, const Rig& rig) {
  constexpr std::size_t kLeastRows = 3;
  constexpr double kMost = 2.5;
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
  return wrong.sigmas >= kMost ? std::optional(wrong) : std::nullopt;
}

std::string to_string(const WrongHeight& wrong) {
  return fmt::format(
      "the vehicle stands {:.3f} m above the floor on the median of the rows, and the rig says "
      "{:.3f} m ({:.1f} standard deviations): the rig's vehicle.height or cameras are wrong, or "
      "the photos are mirrored top to bottom",
      wrong.height, wrong.stated, wrong.sigmas);
}

std::string to_string(const TurnedHeadings& turned) {
  return fmt::format(
      "the headings are turned by {:.0f} degrees to the {} of the way that the vehicle went, in {} "
      "steps: a camera looks elsewhere than the rig says, or its photos are another camera's",
      std::abs(degrees(turned.angle)), turned.angle > 0 ? "right" : "left", turned.steps);
}

}  // namespace tagsmith::detail
