// SPDX-License-Identifier: Apache-2.0
// Live localization: measurements in, positions out, one JSON object a line.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/live_track.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/run.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

struct FollowInput {
  const std::vector<Survey>& surveys;
  const Rig& rig;
  // The position of one measurement by these surveys, where the motion may say what to expect, and
  // what it shows: measurements are compared, and tags that they show to hang elsewhere than
  // surveyed (LiveSetAside) are not used from there on.
  std::function<Fix(const Measurement&, const std::vector<Survey>&, const std::optional<PosePrior>&,
                    Observation&)>
      localize;
  // Whether measurements with a time are tracked: the motion so far says where to look for tags and
  // judges fixes. The method must give attitudes.
  bool track = false;
  bool confirmed = false;  // whether positions that nothing confirms are refused
  bool explain = false;
};

// Reads a measurement a line from standard input until its end and answers each at once on standard
// output (docs/formats.md). A line that is no measurement is answered with status "error". Exit
// code 0 when every measurement was located and none is in doubt, else 1.
int follow(const FollowInput& input);

}  // namespace tagsmith::detail
