// SPDX-License-Identifier: Apache-2.0
// Cables, pipes and boards across a tag, detected where they cross what is known beforehand.
#pragma once

#include <array>
#include <vector>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

// The area between two crossings, clockwise in the unit square of the frame's inside; its corners
// may lie outside of it.
using Occluder = std::array<PixelPoint, 4>;

// Straight objects that cross the white between bars and frame (or the frame's stroke) twice and
// show no bars on the way; those of strips_along_bars are included. The frame begins at P.
std::vector<Occluder> find_occluders(const GrayView& image, const RefinedFrame& frame,
                                     const SymbolLayout& layout);

// Where an occluder hides a row of the unit square, at height v: from begin to end; nowhere where
// end < begin.
struct HiddenWidth {
  double begin = 0;
  double end = -1;
};
HiddenWidth hidden_width(const Occluder& occluder, double v);

// Straight objects along the bars that hide most of a module's height. Such an object changes a
// digit alike in all rows, so the bars alone do not reveal it. It is detected where it crosses the
// white above and below the bars; one as light as the plate, where it crosses the frame's stroke
// above and below. Quick where white and stroke are clear. The frame begins at P.
std::vector<Occluder> strips_along_bars(const GrayView& image, const RefinedFrame& frame,
                                        const SymbolLayout& layout);

}  // namespace tagsmith::detail
