// SPDX-License-Identifier: Apache-2.0
// Where a surveyed tag would be expected to hang, from the design or from its neighbours, and the
// slip in writing that explains why it does not. Internal to tagsmith/survey.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tagsmith/survey/check_tags.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// How far off tags may be from where others say: a length, and times the others' median deviation.
inline constexpr double kLeastTolerance = 0.1;  // metres
inline constexpr double kScatterTolerance = 8;

// Address of a plate in the tunnel: of its frame's middle along and across, of P in height. Metres.
struct PlateAddress {
  double chainage = 0;
  double behind_wall = 0;  // behind the plane of its wall (negative: in the room)
  double height = 0;       // above the floor
};

PlateAddress plate_address(const Survey& survey, Side side, const Eigen::Vector3d& p_in_grid);

// The address of a tag by its neighbours (or the design), and how far off it a good one may be.
struct ExpectedPlace {
  double chainage = 0;
  double height = 0;
  double chainage_tolerance = 0;
  double height_tolerance = 0;
  double chainage_scatter = 0;  // how well a tag without a slip agrees
};

// The expectation for each tag of one wall, in the order given (by pair). Where a measured tag
// replaces a designed one, it is the design. Elsewhere it is the median over the three tags on
// either side, so that a wrong one does not affect its neighbours' expectations; nothing on a wall
// of fewer than five tags. Tolerances grow with the scatter of the wall's own tags.
std::vector<std::optional<ExpectedPlace>> expected_places(
    const Survey& survey, const std::vector<const SourcedTag*>& wall);

bool fits_along(const PlateAddress& address, const ExpectedPlace& expected);
bool fits_in_height(const PlateAddress& address, const ExpectedPlace& expected);

// The coordinates that may have been meant: x and y exchanged, a sign lost, the decimal point one
// place off, two neighbouring digits exchanged (147.19 for 174.19). Nothing unless exactly one such
// slip puts the plate on its wall where it is expected.
std::optional<std::string> likely_slip(const Survey& survey, const PlacedTag& tag,
                                       const ExpectedPlace& expected);

// Median; NaN of nothing.
double median(std::vector<double> values);

}  // namespace tagsmith::detail
