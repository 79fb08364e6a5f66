// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/geometry/vehicle_stance.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kContradictions = 3;  // in a row, after which the motion is doubted, not the fixes

// A row of the run in a track.
struct Step {
  std::size_t row = 0;
  MotionCovariance transition = MotionCovariance::Identity();  // from the step before
  MotionEstimate predicted;
  MotionEstimate filtered;
  bool used = false;       // its fix
  bool confirmed = false;  // its fix, by the motion before it
};

struct Track {
  std::vector<Step> steps;
  int used = 0;               // fixes
  bool contradicted = false;  // by the track before or after it
};

// The filter's step: the fix is used when it agrees with the motion.
void filter(Step& step, const std::optional<MeasuredPlace>& measured) {
  step.filtered = step.predicted;
  if (!measured) return;
  const MotionUpdate update = updated(step.predicted, *measured);
  step.used = update.agrees;
  if (update.agrees) step.filtered = update.estimate;
}

Step next_step(const Step& before, std::size_t row, double dt, const MotionModel& motion) {
  Step step;
  step.row = row;
  step.transition = transition_over(dt);
  step.predicted = predicted(before.filtered, dt, motion);
  return step;
}

// The fixes of a track that the motion before them confirms.
void find_confirmed(Track& track, const std::vector<Fix>& fixes,
                    const std::vector<std::optional<MeasuredPlace>>& measured) {
  TrackTags tags;
  for (Step& step : track.steps) {
    if (!step.used) continue;
    const MotionUpdate update = updated(step.predicted, *measured[step.row]);
    step.confirmed = take_in(tags, step.predicted, update, fixes[step.row]);
  }
}

// The track that begins at `row`. It ends with the run, or before the first of several fixes in a
// row that contradict it.
Track track_from(std::size_t row, const std::vector<std::optional<MeasuredPlace>>& measured,
                 const std::vector<double>& times, const MotionModel& motion) {
  Track track;
  const auto first = std::find_if(measured.begin() + static_cast<std::ptrdiff_t>(row),
                                  measured.end(), [](const auto& fix) { return fix.has_value(); });
  if (first == measured.end()) return track;
  Step start;
  start.row = row;
  start.predicted = motion_from((*first)->place, motion);
  int contradictions = 0;
  std::size_t contradicted_from = 0;
  for (; row < measured.size(); ++row) {
    Step step = track.steps.empty()
                    ? start
                    : next_step(track.steps.back(), row, times[row] - times[row - 1], motion);
    filter(step, measured[row]);
    track.steps.push_back(step);
    if (step.used) ++track.used;
    if (step.used) contradictions = 0;
    if (step.used || !measured[row]) continue;
    if (contradictions++ == 0) contradicted_from = track.steps.size() - 1;
    if (contradictions < kContradictions) continue;
    track.steps.resize(contradicted_from);
    track.contradicted = true;
    break;
  }
  return track;
}

// Of a track that is given up only the first fix counts as wrong: the next begins right after it.
void end_after_first_fix(Track& track) {
  const auto first = std::ranges::find(track.steps, true, &Step::used);
  track.steps.erase(first + 1, track.steps.end());
  track.used = 1;
}

std::vector<Track> tracks_of(const std::vector<std::optional<MeasuredPlace>>& measured,
                             const std::vector<double>& times, const MotionModel& motion) {
  std::vector<Track> tracks;
  std::size_t row = 0;
  while (row < measured.size()) {
    Track track = track_from(row, measured, times, motion);
    if (track.steps.empty()) break;
    if (track.contradicted && track.used < kContradictions) end_after_first_fix(track);
    if (!tracks.empty()) track.contradicted = true;
    row = track.steps.back().row + 1;
    tracks.push_back(std::move(track));
  }
  return tracks;
}

// Rauch, Tung and Striebel's backward pass, (3.29) to (3.31): the estimate of each step from all.
std::vector<MotionEstimate> smoothed(const Track& track) {
  std::vector<MotionEstimate> estimates(track.steps.size());
  estimates.back() = track.steps.back().filtered;
  for (std::size_t i = track.steps.size() - 1; i-- > 0;) {
    const Step& step = track.steps[i];
    const Step& next = track.steps[i + 1];
    const MotionCovariance gain =
        solve_symmetric(next.predicted.covariance, next.transition * step.filtered.covariance)
            .transpose();
    const MotionEstimate& later = estimates[i + 1];
    estimates[i].mean = step.filtered.mean + gain * (later.mean - next.predicted.mean);
    estimates[i].covariance =
        step.filtered.covariance + propagated(gain, later.covariance - next.predicted.covariance);
  }
  return estimates;
}

// The used step nearest in time; there is one in every track.
const Step& nearest_used(const Track& track, std::size_t row, const std::vector<double>& times) {
  return *std::ranges::min_element(track.steps, {}, [&](const Step& step) {
    return step.used ? std::abs(times[step.row] - times[row])
                     : std::numeric_limits<double>::infinity();
  });
}

// Removes what describes the position that the fix had.
void forget_measurement(Fix& fix) {
  fix.ranges.clear();
  fix.dropped.clear();
  fix.corners.clear();
  fix.unchecked.clear();
  fix.confirmations = 0;
  fix.unconfirmed.clear();
  fix.chi_square = 0;
  fix.degrees_of_freedom = 0;
  fix.variance_factor = 1;
  std::erase(fix.notes, kOneTagOnly);
}

Fix without_position(Fix fix, std::string reason) {
  if (fix.position_in_grid) forget_measurement(fix);
  fix.position_in_grid.reset();
  fix.covariance_in_grid.reset();
  fix.attitude.reset();
  fix.pose_covariance_in_grid.reset();
  fix.budget.reset();
  fix.predicted = false;
  fix.reason = std::move(reason);
  return fix;
}

// Of a vehicle that stands there on the floor, in the grid.
Attitude attitude_on_floor(const VehiclePlace& place, const Survey& survey) {
  const Eigen::Vector3d at = world_from_grid(survey.grid, place.head<3>());
  const Centerline& centerline = survey.tunnel.centerline;
  const CenterlinePoint floor = centerline.at(centerline.locate(at.head<2>()).chainage);
  const double yaw = world_heading_from_grid(survey.grid, place[3]) - floor.heading;
  const VehiclePose vehicle = vehicle_on_floor(floor, {.yaw = yaw});
  return {place[3], vehicle.pitch, vehicle.roll};
}

// The fix with the place that the whole track gives it.
Fix with_place(Fix fix, const VehiclePlace& place, const PlaceCovariance& covariance,
               const Rig& rig) {
  const Attitude before = *fix.attitude;
  PoseCovariance pose = PoseCovariance::Zero();
  pose.topLeftCorner<4, 4>() = covariance;
  pose(4, 4) = rig.pitch_sigma * rig.pitch_sigma;
  pose(5, 5) = rig.roll_sigma * rig.roll_sigma;
  if (fix.pose_covariance_in_grid) {
    pose.bottomRightCorner<2, 2>() = fix.pose_covariance_in_grid->bottomRightCorner<2, 2>();
  }
  fix.position_in_grid = place.head<3>();
  fix.attitude = Attitude{wrapped_angle(place[3]), before.pitch, before.roll};
  fix.covariance_in_grid = covariance.topLeftCorner<3, 3>();
  fix.pose_covariance_in_grid = pose;
  fix.budget.reset();  // its parts no longer add up to the covariance
  fix.reason.clear();
  return fix;
}

// The fix of a gap: a prediction, or why there is none.
Fix predicted_fix(Fix fix, const VehiclePlace& place, const PlaceCovariance& covariance, double gap,
                  const Survey& survey, const Rig& rig, const MotionModel& motion) {
  const std::string own =
      fix.position_in_grid ? "its own position contradicts the motion" : fix.reason;
  const double sigma = worst_sigma(covariance.topLeftCorner<3, 3>());
  std::string refusal =
      outside_tunnel(survey.tunnel, world_from_grid(survey.grid, place.head<3>()));
  if (sigma > motion.largest_sigma) {
    refusal = fmt::format("the motion predicts it to {:.2f} m only", sigma);
  }
  if (gap > motion.longest_gap) {
    refusal = fmt::format("{:.1f} s from the nearest measured position", gap);
  }
  if (!refusal.empty()) return without_position(std::move(fix), own + "; " + refusal);
  if (fix.position_in_grid) forget_measurement(fix);
  fix.attitude = attitude_on_floor(place, survey);
  fix.pose_covariance_in_grid.reset();
  fix.tags.clear();
  fix.ranges.clear();
  fix = with_place(std::move(fix), place, covariance, rig);
  fix.predicted = true;
  fix.survey = survey.name;
  fix.notes.push_back(fmt::format(
      "predicted from the motion, {:.2f} s from the nearest measured position: {}", gap, own));
  return fix;
}

std::vector<double> times_of(const Run& run) {
  std::vector<double> times;
  for (const Measurement& measurement : run.measurements) times.push_back(*measurement.time);
  return times;
}

Result<std::vector<std::optional<MeasuredPlace>>> places_of(const std::vector<Fix>& fixes) {
  std::vector<std::optional<MeasuredPlace>> measured;
  for (const Fix& fix : fixes) {
    if (fix.position_in_grid && (!fix.attitude || !fix.pose_covariance_in_grid)) {
      return fail(fmt::format(
          "measurement {} has no heading with a covariance, which smoothing needs (the {} method "
          "gives none)",
          fix.id, fix.method));
    }
    measured.push_back(measured_by(fix));
  }
  return measured;
}

struct Job {
  const std::vector<Fix>& fixes;
  const std::vector<std::optional<MeasuredPlace>>& measured;
  const std::vector<double>& times;
  const std::vector<Survey>& surveys;
  const Rig& rig;
  const MotionModel& motion;
};

// The result for one row of the track, from its fix and the track.
Fix fix_in_track(const Job& job, const Track& track, const Step& step,
                 const MotionEstimate& estimate) {
  const Fix& fix = job.fixes[step.row];
  if (track.contradicted && track.used < kContradictions) {
    return without_position(
        fix, fix.position_in_grid ? "contradicts the motion before or after it" : fix.reason);
  }
  const Step& nearest = step.used ? step : nearest_used(track, step.row, job.times);
  const MeasuredPlace& anchor = *job.measured[nearest.row];
  const VehiclePlace place = estimate.mean.head<4>();
  const PlaceCovariance covariance =
      estimate.covariance.topLeftCorner<4, 4>() + anchor.shared * anchor.covariance;
  if (step.used) {
    Fix placed = with_place(fix, place, covariance, job.rig);
    return step.confirmed ? confirmed_by_motion(std::move(placed)) : placed;
  }
  if (fix.position_in_grid && fix.confirmations > 0) {
    // It cannot be determined whether the place or the time is wrong.
    return without_position(fix, "its position by several tags contradicts the motion");
  }
  const double gap = std::abs(job.times[nearest.row] - job.times[step.row]);
  const Survey& survey = survey_of(job.fixes[nearest.row], job.surveys);
  Fix predicted = predicted_fix(fix, place, covariance, gap, survey, job.rig, job.motion);
  const Fix& relied = job.fixes[nearest.row];
  predicted.confirmations =
      nearest.confirmed ? confirmed_by_motion(relied).confirmations : relied.confirmations;
  return predicted;
}

}  // namespace

Result<void> check_times(const Run& run) {
  std::optional<double> before;
  for (const Measurement& measurement : run.measurements) {
    const std::string place = fmt::format("{}:{}: ", run.file.string(), measurement.line);
    if (!measurement.time) {
      return fail(place +
                  "no time, which smoothing needs in every row: add a column `time` in seconds");
    }
    if (before && !(*measurement.time > *before)) {
      return fail(place + fmt::format("time {} is not after {}, expected rows in the order of time",
                                      *measurement.time, *before));
    }
    before = measurement.time;
  }
  return {};
}

Result<std::vector<Fix>> smooth_fixes(const std::vector<Fix>& fixes, const Run& run,
                                      const std::vector<Survey>& surveys, const Rig& rig,
                                      const MotionModel& motion) {
  if (const auto usable = check_times(run); !usable) return fail(usable);
  const std::vector<double> times = times_of(run);
  const auto measured = places_of(fixes);
  if (!measured) return fail(measured);
  const Job job{fixes, *measured, times, surveys, rig, motion};
  std::vector<Fix> result = fixes;
  for (Track& track : tracks_of(*measured, times, motion)) {
    find_confirmed(track, fixes, *measured);
    const std::vector<MotionEstimate> estimates = smoothed(track);
    for (std::size_t i = 0; i < track.steps.size(); ++i) {
      const Step& step = track.steps[i];
      result[step.row] = fix_in_track(job, track, step, estimates[i]);
    }
  }
  return result;
}

}  // namespace tagsmith::detail
