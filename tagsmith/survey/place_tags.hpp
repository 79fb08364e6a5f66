// SPDX-License-Identifier: Apache-2.0
// From the design of the regular pairs to plates on the walls.
#pragma once

#include <optional>
#include <string>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// More tags than this in one survey are refused.
inline constexpr int kMostTags = 1'000'000;

// "000L" of pair 0, left.
std::string tag_name(int pair, Side side);

// The pair and side that a name says; nothing for any other text than tag_name's.
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

// A tag whose corner P was surveyed, and where it says so its attitude. `digits` and
// `coded_in_grid` are left empty.
PlacedTag place_surveyed(const Survey& survey, const TagName& name,
                         const Eigen::Vector3d& p_in_grid,
                         const std::optional<PlateAttitude>& attitude = std::nullopt);

// The tag with the digits of its own position; nothing when the code cannot say it.
std::optional<PlacedTag> with_own_digits(PlacedTag tag, const PositionCode& code);

// The tag with these printed digits.
PlacedTag with_digits(PlacedTag tag, const PositionCode& code, const Digits& digits);

}  // namespace tagsmith::detail
