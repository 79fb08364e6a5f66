// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/motion.hpp"

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"

namespace tagsmith::detail {
namespace {

// Chi-square of four degrees of freedom that one in 10,000 exceeds.
constexpr double kAgreementGate = 23.51;

// Why: docs/decisions/0011-smoothing-and-paper-method.md.
double shared_part(const Fix& fix) {
  if (!fix.budget) return 0;
  const ErrorBudget& budget = *fix.budget;
  const double shared =
      (budget.edges + budget.survey + budget.coding + budget.calibration + budget.vehicle).trace();
  constexpr double kMost = 0.9;  // some noise stays a fix's own, so that the filter can weigh it
  return std::clamp(shared / fix.covariance_in_grid->trace(), 0.0, kMost);
}

// White acceleration (Bar-Shalom, Li and Kirubarajan 2001, "Estimation with applications to
// tracking and navigation", 6.2.2).
MotionCovariance noise_over(double dt, const MotionModel& motion) {
  const Eigen::Vector4d density =
      Eigen::Vector4d(motion.acceleration, motion.acceleration, motion.climb, motion.turn)
          .cwiseAbs2();
  MotionCovariance noise = MotionCovariance::Zero();
  noise.topLeftCorner<4, 4>() = (dt * dt * dt / 3 * density).asDiagonal();
  noise.topRightCorner<4, 4>() = (dt * dt / 2 * density).asDiagonal();
  noise.bottomLeftCorner<4, 4>() = noise.topRightCorner<4, 4>();
  noise.bottomRightCorner<4, 4>() = (dt * density).asDiagonal();
  return noise;
}

}  // namespace

std::optional<MeasuredPlace> measured_by(const Fix& fix) {
  if (!fix.position_in_grid) return std::nullopt;
  MeasuredPlace measured;
  measured.place << *fix.position_in_grid, fix.attitude->heading;
  measured.covariance = fix.pose_covariance_in_grid->topLeftCorner<4, 4>();
  measured.shared = shared_part(fix);
  return measured;
}

MotionEstimate motion_from(const VehiclePlace& place, const MotionModel& motion) {
  constexpr double kAnywhere = 100;
  MotionEstimate prior;
  prior.mean.head<4>() = place;
  MotionState sigma;
  sigma << kAnywhere, kAnywhere, kAnywhere, 2 * std::numbers::pi, motion.speed, motion.speed,
      motion.speed, motion.turn_rate;
  prior.covariance = sigma.cwiseAbs2().asDiagonal();
  return prior;
}

MotionCovariance transition_over(double dt) {
  MotionCovariance transition = MotionCovariance::Identity();
  transition.topRightCorner<4, 4>() = dt * Eigen::Matrix4d::Identity();
  return transition;
}

MotionEstimate predicted(const MotionEstimate& estimate, double dt, const MotionModel& motion) {
  const MotionCovariance transition = transition_over(dt);
  MotionEstimate later;
  later.mean = transition * estimate.mean;
  later.covariance = propagated(transition, estimate.covariance) + noise_over(dt, motion);
  return later;
}

// Why: docs/decisions/0009-position-consensus.md.
bool take_in(TrackTags& tags, const MotionEstimate& predicted, const MotionUpdate& update,
             const Fix& fix) {
  constexpr double kLargestSigma = 0.025;  // metres, worst direction
  constexpr double kSure = 13.28;          // chi-square of four that one in 100 exceeds
  const Eigen::Matrix3d spread = predicted.covariance.topLeftCorner<3, 3>();
  const bool sharp = worst_sigma(spread) <= kLargestSigma;
  const std::vector<std::string> used = unique_tags(fix);
  const bool handed_over = std::ranges::any_of(tags.latest, [&](const std::string& tag) {
    return std::ranges::find(used, tag) == used.end();
  });
  const bool checked = handed_over && sharp && update.distance2 <= kSure;
  if (checked) tags.confirmed.insert(tags.latest.begin(), tags.latest.end());
  if (checked || used.size() > 1) tags.confirmed.insert(used.begin(), used.end());
  tags.latest = {used.begin(), used.end()};
  return checked || (used.size() == 1 && tags.confirmed.contains(used.front()));
}

Fix confirmed_by_motion(Fix fix) {
  if (!fix.unconfirmed.empty()) return fix;
  ++fix.confirmations;
  std::erase(fix.notes, kOneTagOnly);
  return fix;
}

MotionUpdate updated(const MotionEstimate& predicted, const MeasuredPlace& measured) {
  MotionUpdate update{predicted};
  VehiclePlace missing = measured.place - predicted.mean.head<4>();
  missing[3] = wrapped_angle(missing[3]);
  const PlaceCovariance own = (1 - measured.shared) * measured.covariance;
  const PlaceCovariance spread = predicted.covariance.topLeftCorner<4, 4>();
  update.distance2 = squared_mahalanobis(missing, spread + measured.covariance);
  update.agrees = update.distance2 <= kAgreementGate;
  const PlaceCovariance innovation = spread + own;
  const Eigen::Matrix<double, 8, 4> gain =
      solve_symmetric(innovation, predicted.covariance.topRows<4>()).transpose();
  update.estimate.mean += gain * missing;
  // Joseph's form keeps it positive.
  MotionCovariance rest = MotionCovariance::Identity();
  rest.leftCols<4>() -= gain;
  update.estimate.covariance = propagated(rest, predicted.covariance) + propagated(gain, own);
  return update;
}

}  // namespace tagsmith::detail
