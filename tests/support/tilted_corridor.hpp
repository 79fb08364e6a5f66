// SPDX-License-Identifier: Apache-2.0
// The shipped corridor as a survey that says that all its plates lean.
#pragma once

#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail::test {

// The survey file's text; `tilt`: degrees, the upper edges forward.
inline std::string tilted_corridor(double tilt) {
  const std::string file = "surveys/corridor/survey.yaml";
  const auto survey = load_survey(file);
  REQUIRE(survey);
  std::string text = *read_file(file) + "placed:\n";
  for (const PlacedTag& tag : survey->tags) {
    const Eigen::Vector3d& p = tag.p_in_grid;
    text += fmt::format("  - {{ tag: {}, side: {}, p: [{}, {}, {}], tilt: {} }}\n", tag.name,
                        to_string(tag.side), p.x(), p.y(), p.z(), tilt);
  }
  return text;
}

}  // namespace tagsmith::detail::test
