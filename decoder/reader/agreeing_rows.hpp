// SPDX-License-Identifier: Apache-2.0
// The scan profile of rows that agree.
#pragma once

#include <array>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/reader/symbol_rows.hpp"
#include "decoder/scan/profile.hpp"

namespace tagsmith::detail {

// The light of the plate's white and of the frame's black at the ends of the frame's upper and
// lower sides: at (0,0) (1,0) (1,1) (0,1) of the unit square.
struct PlateLevels {
  std::array<double, 4> white{};
  std::array<double, 4> black{};
};

// For each bin the mean darkness of the rows of a part of the frame's inner height that are near
// their median, with what the others make doubtful.
ScanProfile profile_of_agreeing(const SymbolRows& rows, const PlateLevels& levels, double top,
                                double bottom);

}  // namespace tagsmith::detail
