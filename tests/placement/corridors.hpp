// SPDX-License-Identifier: Apache-2.0
// Tunnels, tags and rigs for tests of plans.
#pragma once

#include <optional>
#include <vector>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tests/support/corridor_template.hpp"

namespace tagsmith::detail::test {

// The paper's corridor plates in a tunnel of this course.
inline Survey survey_along(std::vector<CenterlineElement> elements, int pairs,
                           double spacing = 0.4) {
  Survey survey;
  survey.file = "trial/survey.yaml";
  survey.name = "trial";
  survey.tunnel.left = -0.95;
  survey.tunnel.right = 0.95;
  survey.tunnel.height = 3;
  survey.tunnel.centerline = Centerline({0, 0, 0}, 0, std::move(elements));
  survey.tag_template = corridor_template();
  survey.sigma = 0.002;
  survey.series = TagSeries{0.4, spacing, 0.1, pairs, std::nullopt};
  for (int pair = 0; pair < pairs; ++pair) {
    survey.tags.push_back(place_in_series(survey, pair, Side::left));
    survey.tags.push_back(place_in_series(survey, pair, Side::right));
  }
  return survey;
}

inline Survey straight_survey(double length, int pairs, double spacing = 0.4) {
  return survey_along({{length, 0, 0}}, pairs, spacing);
}

// The paper's crawler.
inline Rig crawler() {
  Rig rig;
  rig.file = "trial/rig.yaml";
  rig.name = "crawler";
  for (const Side side : {Side::left, Side::right}) {
    RigCamera camera;
    camera.name = to_string(side);
    camera.camera = camera_from_sensor(1280, 960, 0.006, 0.0048, 0.0036);
    camera.vehicle_from_camera = vehicle_from_side_camera(side, radians(35));
    rig.cameras.push_back(camera);
  }
  rig.ranges.push_back({"d", Side::left, 0.25, 5, 0.01});
  rig.vehicle_height = 0.24;
  rig.roll_sigma = rig.pitch_sigma = radians(2);
  return rig;
}

}  // namespace tagsmith::detail::test
