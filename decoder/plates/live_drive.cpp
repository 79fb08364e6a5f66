// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/live_drive.hpp"

#include <utility>

namespace tagsmith::detail {

LiveDrive::LiveDrive(std::vector<Survey> surveys, const Rig& rig)
    : surveys_(std::move(surveys)), rig_(&rig), aside_(surveys_) {}

Fix LiveDrive::next(const LocateOne& locate, std::optional<double> time) {
  const auto prior =
      time && track_ ? prior_at(*track_, *time, surveys_, MotionModel{}) : std::nullopt;
  Observation seen;
  Fix fix = locate(aside_.surveys(), prior, seen);
  const RunCheck check = aside_.learn(std::move(seen), fix, *rig_);
  if (!check.aside.empty()) fix = locate(aside_.surveys(), prior, seen);
  for (const SetAside& tag : check.aside) {
    fix.notes.push_back("set aside from here on: " + tag.message);
  }
  if (time) fix = follow_track(track_, std::move(fix), *time, surveys_);
  fix = doubts_.judged(std::move(fix), surveys_, *rig_);
  const bool doubt_rig = fix.doubt.empty() && !check.rig_doubt.empty();
  return doubt_rig ? doubted(std::move(fix), "the rig is in doubt: " + check.rig_doubt) : fix;
}

}  // namespace tagsmith::detail
