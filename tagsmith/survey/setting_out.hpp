// SPDX-License-Identifier: Apache-2.0
// Where each plate goes, in the words of who hangs it.
#pragma once

#include <span>
#include <vector>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// Corner P of a tag: its address along the drive beside its coordinates. Metres.
struct SettingOut {
  const PlacedTag* tag = nullptr;
  double chainage = 0;
  double offset = 0;     // from the center line, negative = left of the drive
  double height = 0;     // above the floor at P's chainage
  double tolerance = 0;  // how far from here P may be hung
};

// Of corner P above the floor at its chainage.
double height_of_p(const Survey& survey, const PlacedTag& tag);

// Of corner P from the center line, negative = left of the drive.
double offset_of_p(const Survey& survey, const PlacedTag& tag);

// How far a plate may hang from its place unless the user says otherwise: twice the standard
// deviation of a surveyed coordinate where the survey states it, but no less than what a tape and a
// level can do.
double usual_tolerance(const Survey& survey);

std::vector<SettingOut> setting_out(const Survey& survey, std::span<const PlacedTag* const> tags,
                                    double tolerance);

}  // namespace tagsmith::detail
