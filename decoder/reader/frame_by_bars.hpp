// SPDX-License-Identifier: Apache-2.0
// Feature frames of which sides are hidden, completed from the bars inside.
#pragma once

#include <optional>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/bar_regions.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith {

// The frame around the bars of a region: the bars say where the left and right sides are (to half a
// module or so), the picture where the upper and lower ones; each is then fitted if it shows there.
// `half` is the image at half its size. Nothing where the bars are not much like a symbol or the
// upper or lower side does not show.
std::optional<RefinedFrame> frame_by_bars(const GrayView& image, const GrayView& half,
                                          const BarRegion& region, const SymbolLayout& layout);

// The frame fitted anew around a symbol that was read: `expected` is where its bars put the frame's
// corners, clockwise from P. Left and right sides that are not there are taken for hidden.
std::optional<RefinedFrame> frame_by_symbol(const GrayView& image, const GrayView& half,
                                            const Quad& expected, double module_px);

// Whether the bars end where a frame with these corners (clockwise from P) has them end, within a
// pixel or so, at three of the ends of their left and right halves: what has an edge like the
// frame's upper or lower side and is not it fails.
bool bars_end_as_expected(const GrayView& image, const Quad& corners, const SymbolLayout& layout);

}  // namespace tagsmith
