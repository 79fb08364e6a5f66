// SPDX-License-Identifier: Apache-2.0
#include "decoder/plates/live_drive.hpp"

#include <utility>

namespace tagsmith::detail {

LiveDrive::LiveDrive(std::vector<Survey> surveys, const Rig& rig)
    : rig_(&rig), aside_(std::move(surveys)) {}

Fix LiveDrive::next(const LocalizeOne& localize, std::optional<double> time) {
  const auto prior =
      time && track_ ? prior_at(*track_, *time, aside_.all(), MotionModel{}) : std::nullopt;
  Observation seen;
  Fix fix = localize(aside_.surveys(), prior, seen);
  const RunCheck check = aside_.learn(std::move(seen), fix, *rig_);
  if (!check.aside.empty()) fix = localize(aside_.surveys(), prior, seen);
  set_aside_notes_.clear();
  for (const SetAside& tag : check.aside) {
    set_aside_notes_.push_back("set aside from here on: " + tag.message);
  }
  fix.notes.insert(fix.notes.end(), set_aside_notes_.begin(), set_aside_notes_.end());
  if (time) fix = follow_track(track_, std::move(fix), *time);
  fix = doubts_.judged(std::move(fix), aside_.all(), *rig_);
  const std::string doubt = doubt_in_words(check, *rig_);
  return doubt.empty() || !fix.doubt.empty() ? fix : doubted(std::move(fix), doubt);
}

}  // namespace tagsmith::detail
