// SPDX-License-Identifier: Apache-2.0
// The heights of a designed alignment: grades, and vertical curves between them. Internal to
// tagsmith/survey.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tagsmith/base/result.hpp"

namespace tagsmith::detail {

// Where two grades meet. Lengths in the file's unit.
struct GradeChange {
  Eigen::Vector2d at{0, 0};  // station, height
  // Of a parabola, horizontally, before and behind the station; both 0: a corner.
  double before = 0;
  double behind = 0;
  // Of a circular arc, whose length may be said too.
  std::optional<double> radius{};
  std::optional<double> arc_length{};
};

// Stations and heights, rising in their stations, that chords join.
using VerticalProfile = std::vector<Eigen::Vector2d>;

// The changes of grade with their curves as chords that are off them by at most `sag`. Fails with
// words for the user where stations do not rise, curves overlap or begin beyond the profile, or an
// arc is not as long as it says.
Result<VerticalProfile> profile_of_grades(const std::vector<GradeChange>& changes, double sag);

// Whether the profile says a height there, to `slack`.
bool reaches(const VerticalProfile& profile, double station, double slack);

// Of a profile that has points; beyond its ends that of its end.
double height_at(const VerticalProfile& profile, double station);

}  // namespace tagsmith::detail
