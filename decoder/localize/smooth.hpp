// SPDX-License-Identifier: Apache-2.0
// The fixes of a run used together: between two of them a vehicle neither jumps nor turns on the
// spot.
#pragma once

#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/motion.hpp"
#include "tagsmith/base/result.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Fails, naming the row, when one has no time or not a later one than the row before.
Result<void> check_times(const Run& run);

// The run's positions by a Kalman filter and the smoother of Rauch, Tung and Striebel 1965
// ("Maximum likelihood estimates of linear dynamic systems") over constant velocities in x, y, z
// and heading. `fixes[i]` belongs to `measurements[i]`, whose times must increase.
//
// - A fix that lies farther from the motion than one in 10,000 would (chi-square of four) is not
//   used; its row is treated as a gap and says so. When three in a row contradict the motion, a new
//   track begins with them; a track that the next one contradicts and that has fewer than three
//   fixes of its own gives no positions.
// - Rows without a fix of their own get the predicted position, `Fix::predicted`, with the
//   covariance that grows with the distance from the fixes. No position where that is farther from
//   a fix than `longest_gap`, less certain than `largest_sigma`, or in the rock.
// - Errors that neighbouring fixes share (survey, coding, calibration, stance: by the fixes' error
//   budgets) are not averaged away: that share of a fix's covariance is put back whole, to a gap
//   that of the nearest fix.
//
// Pitch and roll stay those of the fix; in gaps they are level with the rig's standard deviations.
// Fails as check_times does, and with fixes that have no attitude or covariance.
Result<std::vector<Fix>> smooth_fixes(const std::vector<Fix>& fixes, const Run& run,
                                      const std::vector<Survey>& surveys, const Rig& rig,
                                      const MotionModel& motion = {});

}  // namespace tagsmith::detail
