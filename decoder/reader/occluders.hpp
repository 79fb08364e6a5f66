// SPDX-License-Identifier: Apache-2.0
// Cables, pipes and boards across a tag, told by where they cross what is known beforehand.
#pragma once

#include <array>
#include <vector>

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

// The area between two crossings, clockwise in the unit square of the frame's inside; its corners
// may lie outside of it.
using Occluder = std::array<PixelPoint, 4>;

// The stroke's thickness as a share of the inner height, of what feature frames have; `corners` are
// those of the inner edge from P on.
double stroke_share(const Quad& corners, double stroke_px);

// Whatever is straight, crosses the white between bars and frame (or the frame's stroke) twice, and
// shows no bars on the way; strips_along_bars among them. `stroke` is the stroke_share.
std::vector<Occluder> find_occluders(const GrayView& image, const FrameHomography& image_from_frame,
                                     const SymbolLayout& layout, double stroke);

// Where an occluder hides a row of the unit square, at height v: from begin to end; nowhere where
// end < begin.
struct HiddenWidth {
  double begin = 0;
  double end = -1;
};
HiddenWidth hidden_width(const Occluder& occluder, double v);

// Straight objects along the bars that hide most of a module's height. Such an object changes a
// digit alike in all rows, so the bars alone do not reveal it. It is found where it crosses the
// white above and below the bars; one as light as the plate, where it crosses the frame's stroke
// above and below. Quick where white and stroke are clear. `stroke` as in find_occluders.
std::vector<Occluder> strips_along_bars(const GrayView& image,
                                        const FrameHomography& image_from_frame,
                                        const SymbolLayout& layout, double stroke);

}  // namespace tagsmith::detail
