// SPDX-License-Identifier: Apache-2.0
// Tags of a run that all its rows together show to hang elsewhere than surveyed, or to be of
// another size: they locate nothing.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "decoder/localize/observation.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

struct SetAside {
  std::size_t survey = 0;  // index of the survey that has the tag
  std::string tag;
  std::string rule;               // docs/verify-rules.md
  std::string message;            // what is wrong, and what to do
  std::vector<std::size_t> rows;  // in which it is set aside, by index
};

struct RunCheck {
  std::vector<SetAside> aside;
  std::vector<std::string> mixed;  // rows that have each other's photos, in words
};

// What check_hung_tags is certain of, survey by survey; what it calls doubtful stays. Takes these
// tags out of the rows, with a fault in each that says so. Nothing where the rig itself is in
// doubt.
RunCheck set_aside_misplaced(std::vector<Observation>& rows, const std::vector<Survey>& surveys,
                             const Rig& rig);

}  // namespace tagsmith::detail
