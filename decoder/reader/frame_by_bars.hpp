// SPDX-License-Identifier: Apache-2.0
// Feature frames of which sides are hidden, completed from the bars inside.
#pragma once

#include <optional>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/located_bars.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

// The frame around bars that were located: these say where the left and right sides are (to half a
// module or so), the picture where the upper and lower ones; each is then fitted if it shows there.
// `half` is the image at half its size. Nothing where the upper or lower side does not show.
std::optional<RefinedFrame> frame_by_bars(const GrayView& image, const GrayView& half,
                                          const LocatedBars& bars, const SymbolLayout& layout,
                                          const LensGuess& lens = {});

// The frame fitted anew around a symbol that was read: `expected` is where its bars put the frame's
// corners, clockwise from P. Left and right sides that are not there are taken for hidden.
std::optional<RefinedFrame> frame_by_symbol(const GrayView& image, const GrayView& half,
                                            const Quad& expected, const SymbolLayout& layout,
                                            double module_px, const LensGuess& lens = {});

}  // namespace tagsmith::detail
