// SPDX-License-Identifier: Apache-2.0
// Live localization: measurements in, positions out, one JSON object a line.
#pragma once

#include <functional>
#include <vector>

#include "decoder/localize/fix.hpp"
#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith {

using LocalizationMethod =
    std::function<Fix(const Observation&, const std::vector<Survey>&, const Rig&)>;

struct FollowInput {
  const std::vector<Survey>& surveys;
  const Rig& rig;
  ReaderChoice reader;
  LocalizationMethod method;
  // Whether measurements with a time are tracked: the motion so far says where to look for tags and
  // judges fixes. The method must give attitudes.
  bool track = false;
  bool explain = false;
};

// Reads a measurement a line from standard input until its end and answers each at once on standard
// output (docs/formats.md). A line that is no measurement is answered with status "error". Exit
// code 0 when every measurement was located, else 1.
int follow(const FollowInput& input);

}  // namespace tagsmith
