// SPDX-License-Identifier: Apache-2.0
// What the fixes so far say about the next, while the vehicle drives.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/motion.hpp"
#include "decoder/reader/reader.hpp"
#include "tagsmith/geometry/observation_model.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Where the vehicle should be, before its images are read.
struct PosePrior {
  VehiclePose vehicle;        // world frame
  double position_sigma = 0;  // metres, worst direction
  double angle_sigma = 0;     // radians, likewise
};

// The tags of a survey that a camera should see from there, where they should be, to three standard
// deviations. None when that is too uncertain to be of use.
std::vector<ExpectedTag> expected_tags(const PosePrior& prior, const Survey& survey,
                                       const RigCamera& camera);
// The same of all surveys, which are in one grid.
std::vector<ExpectedTag> expected_tags(const PosePrior& prior, const std::vector<Survey>& surveys,
                                       const RigCamera& camera);

// The motion on which the latest fixes agree.
struct LiveTrack {
  double time = 0;  // of the estimate, seconds
  MotionEstimate estimate;
  double pitch = 0;
  double roll = 0;
  int used = 0;                   // fixes in the estimate
  TrackTags tags;                 // that these fixes use
  std::set<std::string> refused;  // lone tags, unconfirmed, that the motion contradicted
};

// Nothing when the track is older than the motion model's longest gap, or later than `time`.
std::optional<PosePrior> prior_at(const LiveTrack& track, double time,
                                  const std::vector<Survey>& surveys, const MotionModel& motion);

// Adds a fix of the joint method at `time` to the track, or begins one with it.
//
// A fix that the motion contradicts begins a new track when it uses several tags. When it uses one,
// a misprinted or misplaced plate is the likelier cause: it becomes "no position" with the reason,
// until the track is older than the model's longest gap or confirms the tag; the motion's growing
// uncertainty does not make it acceptable. A fix that the motion confirms (take_in) says so, and a
// single tag's loses the note that nothing does. A time that is not after the track's begins a new
// one, with a note.
Fix follow_track(std::optional<LiveTrack>& track, Fix fix, double time,
                 const MotionModel& motion = {});

}  // namespace tagsmith::detail
