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

// How many standard deviations the vehicle may stand from what the rig says. With one tag alone a
// wrong plate can hardly be detected by anything but the stance.
inline constexpr double kStanceGate = 6.0;
inline constexpr double kLoneStanceGate = 4.0;

// A tag or range is believed while it disagrees less than right ones do once in 10 000 (a normal
// value exceeds 3.7) or, for all corners of a tag, whose noise has heavier tails, in a million.
inline constexpr double kPoseShiftGate = 3.7;
inline constexpr double kCornersGate = 4.75;
inline constexpr double kRangeGate = 4.0;

// A pose and the measurements that it uses.
struct Candidate {
  JointFit fit;
  double chi_square = 0;  // of the same measurements for all candidates: ranges capped
};

struct PoseSearch {
  std::vector<Candidate> candidates;  // distinct, the best first
  std::vector<std::string> reasons;   // of each sighting: why it alone allows no pose
};

// Every pose that a sighting alone allows, with all tags and ranges that agree with it. Where a
// tag's four corners fit a rectangle worse than their covariance says, that covariance is raised
// until they do. Ends early when all tags agree with the poses of one sighting: any other pose that
// the others allow has fewer tags for it.
PoseSearch search_poses(JointProblem& problem);

// The fit of these sightings with every range that agrees with it; nothing when the vehicle cannot
// be there.
std::optional<Candidate> with_ranges(const JointProblem& problem, JointFit fit);

// Whether the vehicle can stand like that, within `gate` standard deviations: empty, or why not.
std::string unlikely_stance(const JointProblem& problem, const JointFit& fit, double gate);

std::size_t plate_count(const JointFit& fit);

// The plates (indices in the problem) that the fit uses.
std::set<std::size_t> plates_of(const JointFit& fit);

}  // namespace tagsmith::detail
