// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tagsmith/base/text.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {

// The shipped corridor's survey, but all of its plates lean forward by so many degrees.
inline std::string tilted_corridor(double tilt) {
  std::string survey = contents("surveys/corridor/survey.yaml");
  const std::string last = "  pairs: 8\n";
  return survey.insert(survey.find(last), "  tilt: " + format_number(tilt) + "\n");
}

}  // namespace tagsmith::detail::test
