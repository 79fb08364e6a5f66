// SPDX-License-Identifier: Apache-2.0
// Positions while a vehicle drives: each from its own measurement and from what the earlier ones
// show of the motion, of the plates and of the rig.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/live_track.hpp"
#include "decoder/localize/observation.hpp"
#include "decoder/localize/travel.hpp"
#include "decoder/plates/set_aside.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// The position from one measurement and these surveys, where the motion may predict the pose; what
// was seen of the surveys' tags is added to the observation. Tags of an observation left empty are
// not compared with those of other measurements.
using LocalizeOne =
    std::function<Fix(const std::vector<Survey>&, const std::optional<PosePrior>&, Observation&)>;

class LiveDrive {
 public:
  // The rig must outlive the drive.
  LiveDrive(std::vector<Survey> surveys, const Rig& rig);

  // The position of the next measurement; without a time it is not judged by the motion. A note
  // says which tags are set aside from here on (LiveSetAside). While the last measurements show
  // that the rig or the positions cannot be trusted, a note says why and nothing confirms the
  // position.
  Fix next(const LocalizeOne& localize, std::optional<double> time);

  // The notes of the last measurement on tags that are set aside.
  const std::vector<std::string>& set_aside_notes() const { return set_aside_notes_; }

 private:
  const Rig* rig_;
  std::optional<LiveTrack> track_;
  LiveSetAside aside_;
  LiveDoubts doubts_;
  std::vector<std::string> set_aside_notes_;
};

}  // namespace tagsmith::detail
