// SPDX-License-Identifier: Apache-2.0
// From the design of the regular pairs to plates on the walls.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// More tags than this in one survey are refused.
inline constexpr int kMostTags = 1'000'000;

// "000L" of pair 0, left.
std::string tag_name(int pair, Side side);

// The pair and side in a name; nothing for any text that tag_name does not return.
struct TagName {
  int pair = 0;
  Side side = Side::left;
};
std::optional<TagName> parse_tag_name(std::string_view name);

// How much further along the drive than the facing plate the right plate of a pair stands whose
// left plate's middle is at this chainage: W_T tan(theta) - L_CI (Xu et al. 2017, Fig 5), 0 without
// theta. W_T is the width there.
double right_plate_shift(const Survey& survey, double chainage);

// Chainage of the middle of the left plate of a pair of the survey's series.
double left_middle(const Survey& survey, int pair);

// The tag of the survey's series (which must be there), hanging as designed: middle of the feature
// frame at chainage first + L_CI/2 + pair * (plate length + spacing), tangent to the wall there,
// P mount_height above the floor at P's chainage. `digits` and `coded_in_grid` are left empty.
PlacedTag place_in_series(const Survey& survey, int pair, Side side);

// A tag whose corner P was surveyed, and its attitude where the survey has it. `digits` and
// `coded_in_grid` are left empty.
PlacedTag place_surveyed(const Survey& survey, const TagName& name,
                         const Eigen::Vector3d& p_in_grid,
                         const std::optional<PlateAttitude>& attitude = std::nullopt);

// The tag with the digits of its own position; nothing when the code cannot represent it.
std::optional<PlacedTag> with_own_digits(PlacedTag tag, const PositionCode& code);

// The tag with these printed digits.
PlacedTag with_digits(PlacedTag tag, const PositionCode& code, const Digits& digits);

// ---- Where each plate belongs, in words for the people who hang them.

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

// How far a plate may hang from its place unless the user states it: twice the standard deviation
// of a surveyed coordinate where the survey states it, but no less than the accuracy of a tape and
// a level.
double usual_tolerance(const Survey& survey);

std::vector<SettingOut> setting_out(const Survey& survey, std::span<const PlacedTag* const> tags,
                                    double tolerance);

// ---- The angle theta of the paper's method for two tags, which the localizer computes with and
// the planner expects.

// The angle theta for a tag on the left wall and one on the right. The one that the survey states,
// when the tags' stagger along the drive is that of a pair, either way round, to an eighth of the
// pitch; else, and when the survey states none, atan(|stagger| / W_T). The margin is for positions
// like those of the paper's Table 4, which are 58 mm (a fourteenth of the pitch) off the theta that
// its authors computed with; in the corridor as designed, tags of two different pairs are off by a
// seventh.
double pair_angle_for(const Survey& survey, const PlacedTag& left, const PlacedTag& right);

// The heading of the drive (world frame) midway between two tags, from their plates' attitudes.
double heading_between(const PlacedTag& left, const PlacedTag& right);

}  // namespace tagsmith::detail
