// SPDX-License-Identifier: Apache-2.0
// Cables, pipes and boards across a tag, told by where they cross what is known beforehand.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "decoder/feature_frame/lens_bend.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith {

// The area between two crossings, clockwise in the unit square of the frame's inside; its corners
// may lie outside of it.
using CoverStrip = std::array<PixelPoint, 4>;

// The stroke's thickness as a share of the inner height, of what feature frames have; `corners` are
// those of the inner edge from P on.
double stroke_share(const Quad& corners, double stroke_px);

// Whatever is straight, crosses the white between bars and frame (or the frame's stroke) twice, and
// shows no bars on the way; strips_along_bars among them. `stroke` is the stroke_share.
std::vector<CoverStrip> find_cover_strips(const GrayView& image, const FrameMap& image_from_unit,
                                          const SymbolLayout& layout, double stroke);

// Which of these places along a row of the unit square, at height v, a strip covers: theirs are
// set in `covered`, which is as long, the others left as they are.
void add_covered(const CoverStrip& strip, double v, std::span<const double> places,
                 std::span<std::int64_t> covered);

// Whether a strip covers anything at a height of the unit square.
bool reaches(const CoverStrip& strip, double v);

// Straight objects along the bars that hide most of a module's height. Such an object changes a
// digit alike in all rows, so the bars alone do not reveal it. It is found where it crosses the
// white above and below the bars; one as light as the plate, where it crosses the frame's stroke
// above and below. Quick where white and stroke are clear. `stroke` as in find_cover_strips.
std::vector<CoverStrip> strips_along_bars(const GrayView& image, const FrameMap& image_from_unit,
                                          const SymbolLayout& layout, double stroke);

}  // namespace tagsmith
