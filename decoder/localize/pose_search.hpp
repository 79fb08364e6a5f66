// SPDX-License-Identifier: Apache-2.0
// The poses that one measurement allows, each with all tags and ranges that agree with it.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "decoder/localize/joint_model.hpp"

namespace tagsmith::detail {

// How many standard deviations the vehicle may stand from what the rig says. With one tag alone
// the stance is nearly all there is to tell a wrong plate by.
inline constexpr double kStanceGate = 6.0;
inline constexpr double kLoneStanceGate = 4.0;

// A tag or range is believed while it disagrees less than right ones do once in 10 000 (a normal
// value exceeds 3.7) or, for all corners of a tag, whose noise has heavier tails, in a million.
inline constexpr double kPoseShiftGate = 3.7;
inline constexpr double kCornersGate = 4.75;
inline constexpr double kRangeGate = 4.0;

// A pose and what it rests on.
struct Candidate {
  JointFit fit;
  double chi_square = 0;  // of the same measurements for all candidates: ranges capped
};

struct PoseSearch {
  std::vector<Candidate> candidates;  // distinct, the best first
  std::vector<std::string> reasons;   // of each sighting: why it allows no pose by itself
  bool contradictory = false;         // two tags that agree with neither's own pose
};

// Every pose that a sighting by itself allows, with all tags and ranges that agree with it. Of a
// tag whose four corners fit a rectangle worse than their covariance says, that covariance is
// raised until they do. Ends early when all tags agree with the poses of one sighting: what else
// the others allow has fewer tags for it.
PoseSearch search_poses(JointProblem& problem);

// The fit of these sightings with every range that agrees with it; nothing when the vehicle cannot
// be there.
std::optional<Candidate> with_ranges(const JointProblem& problem, JointFit fit);

// Whether the vehicle can stand like that, to `gate` standard deviations: empty, or why not.
std::string unlikely_stance(const JointProblem& problem, const JointFit& fit, double gate);

std::size_t plate_count(const JointFit& fit);

// The plates (indices in the problem) that the fit rests on.
std::set<std::size_t> plates_of(const JointFit& fit);

}  // namespace tagsmith::detail
