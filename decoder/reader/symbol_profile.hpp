// SPDX-License-Identifier: Apache-2.0
// The scan profile of the symbol inside a feature frame.
#pragma once

#include <array>
#include <cstddef>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "decoder/scan/profile.hpp"

namespace tagsmith {

struct SymbolProfile {
  ScanProfile bins;
  double module_px = 0;  // width of a module in the middle of the frame
  double blur = 0;       // standard deviation of the point spread, modules, from the frame's sides
};

// A frame's corners and sides from the corner on that is taken for P.
struct TurnedFrame {
  Quad corners{};
  std::array<FrameSide, 4> sides{};
};

TurnedFrame turned_to(const RefinedFrame& frame, std::size_t first_corner);

// Standard deviation of the point spread across the bars, modules, from the left and right side of
// a frame turned to P: with what bins of `bin_width` modules add.
double blur_across(const std::array<FrameSide, 4>& sides, double module_px, double bin_width);

// Averages the pixels of the bars in light (not in samples) along the bars, with the frame's own
// white and black as levels; stretches covered by dirt or glare are left out where the rest of the
// bars' height disagrees with them. `first_corner` is the corner taken for P.
SymbolProfile profile_symbol(const GrayView& image, const RefinedFrame& frame,
                             std::size_t first_corner, const SymbolLayout& layout);

}  // namespace tagsmith
