// SPDX-License-Identifier: Apache-2.0
#include "decoder/localize/live_track.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>

#include "decoder/reader/read_options.hpp"
#include "tagsmith/geometry/covariance.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

bool is_usable(const LiveTrack& track, double time, const MotionModel& motion) {
  return time > track.time && time - track.time <= motion.longest_gap;
}

// Of a track that begins with this fix.
TrackTags tags_of(const Fix& fix) {
  const std::vector<std::string> used = unique_tags(fix);
  TrackTags tags{{used.begin(), used.end()}, {}};
  if (used.size() > 1) tags.confirmed = tags.latest;
  return tags;
}

LiveTrack track_from(const Fix& fix, const MeasuredPlace& measured, double time,
                     const MotionModel& motion) {
  return {time,
          updated(motion_from(measured.place, motion), measured).estimate,
          fix.attitude->pitch,
          fix.attitude->roll,
          1,
          tags_of(fix),
          {}};
}

Fix refused(const Fix& fix, std::string reason) {
  Fix none;
  none.id = fix.id;
  none.method = fix.method;
  none.survey = fix.survey;
  none.tags = fix.tags;
  none.reason = std::move(reason);
  return none;
}

std::string contradiction(const Fix& fix, const MotionEstimate& expected,
                          const MeasuredPlace& measured) {
  const double off = (measured.place - expected.mean.head<4>()).head<3>().norm();
  return fmt::format(
      "the only tag, {}, puts the vehicle {:.3f} m from where its motion since the last fixes "
      "allows: misplaced, misprinted or moved?",
      fix.tags.front(), off);
}

}  // namespace

std::vector<ExpectedTag> expected_tags(const PosePrior& prior, const Survey& survey,
                                       const RigCamera& camera) {
  constexpr double kSigmas = 3;
  constexpr double kModelPixels = 2;    // errors of survey and calibration, roughly
  constexpr double kMostOfTag = 1;      // of its height; beyond, a search is as good
  constexpr double kLeastModule = 0.7;  // pixels: read with certainty
  const Pose camera_from_world =
      inverse(world_from_vehicle(prior.vehicle) * camera.vehicle_from_camera);
  std::vector<ExpectedTag> expected = expected_tags(survey, camera.camera, camera_from_world, 0);
  const double modules = kModuleCount + 2 * survey.tag_template.quiet_zone_modules;
  std::erase_if(expected, [&](const ExpectedTag& tag) {
    return distance(tag.corners[0], tag.corners[1]) < kLeastModule * modules;
  });
  for (ExpectedTag& tag : expected) {
    // A plate hangs upright: its height is hardly foreshortened.
    const double height_px = distance(tag.corners[0], tag.corners[3]);
    const double per_metre = height_px / survey.tag_template.frame_inner_height;
    tag.uncertainty_px = kModelPixels + kSigmas * std::hypot(per_metre * prior.position_sigma,
                                                             camera.camera.fx * prior.angle_sigma);
    if (tag.uncertainty_px > kMostOfTag * height_px) return {};
  }
  return expected;
}

std::vector<ExpectedTag> expected_tags(const PosePrior& prior, const std::vector<Survey>& surveys,
                                       const RigCamera& camera) {
  std::vector<ExpectedTag> expected;
  for (const Survey& survey : surveys) {
    std::ranges::move(expected_tags(prior, survey, camera), std::back_inserter(expected));
  }
  return expected;
}

std::optional<PosePrior> prior_at(const LiveTrack& track, double time,
                                  const std::vector<Survey>& surveys, const MotionModel& motion) {
  if (!is_usable(track, time, motion)) return std::nullopt;
  constexpr double kLean = 0.005;  // radians: pitch and roll from one image to the next
  const MotionEstimate now = predicted(track.estimate, time - track.time, motion);
  const Grid& grid = surveys.front().grid;
  PosePrior prior;
  prior.vehicle.position = world_from_grid(grid, now.mean.head<3>());
  prior.vehicle.heading = world_heading_from_grid(grid, now.mean[3]);
  prior.vehicle.pitch = track.pitch;
  prior.vehicle.roll = track.roll;
  prior.position_sigma = worst_sigma(now.covariance.topLeftCorner<3, 3>());
  prior.angle_sigma = std::hypot(std::sqrt(now.covariance(3, 3)), kLean);
  return prior;
}

Fix follow_track(std::optional<LiveTrack>& track, Fix fix, double time, const MotionModel& motion) {
  const auto measured = measured_by(fix);
  if (!measured) return fix;
  if (!track || !is_usable(*track, time, motion)) {
    if (track && time <= track->time) {
      fix.notes.push_back(
          fmt::format("time {} is not after the {} of the position before: its motion is not used, "
                      "a new track begins",
                      time, track->time));
    }
    track = track_from(fix, *measured, time, motion);
    return fix;
  }
  const MotionEstimate expected = predicted(track->estimate, time - track->time, motion);
  const MotionUpdate update = updated(expected, *measured);
  const bool alone = fix.tags.size() == 1;
  const std::string lone_tag = alone ? unique_tags(fix).front() : std::string();
  if (!update.agrees && !alone) {
    fix.notes.emplace_back("not where the motion since the last fixes leads: a new track begins");
    track = track_from(fix, *measured, time, motion);
    return fix;
  }
  TrackTags tags = track->tags;
  const bool confirmed = update.agrees && take_in(tags, expected, update, fix);
  if (!update.agrees) {
    if (!tags.confirmed.contains(lone_tag)) track->refused.insert(lone_tag);
    return refused(fix, contradiction(fix, expected, *measured));
  }
  if (alone && !confirmed && track->refused.contains(lone_tag)) {
    return refused(fix, fmt::format("the only tag, {}, contradicted the motion before, and nothing "
                                    "has confirmed it since: misplaced, misprinted or moved?",
                                    fix.tags.front()));
  }
  track->tags = std::move(tags);
  track->time = time;
  track->estimate = update.estimate;
  track->pitch = fix.attitude->pitch;
  track->roll = fix.attitude->roll;
  ++track->used;
  return confirmed ? confirmed_by_motion(std::move(fix)) : fix;
}

}  // namespace tagsmith::detail
