// SPDX-License-Identifier: Apache-2.0
// Feature frames of which sides are hidden, completed from the bars inside.
#pragma once

#include <optional>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/located_bars.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

// The frame around bars that were located: the bars give the left and right sides (to half a module
// or so), the picture the upper and lower ones; each is then fitted if it is visible there. `half`
// is the image at half its size. Nothing where the upper or lower side is not visible.
std::optional<RefinedFrame> frame_by_bars(const GrayView& image, const GrayView& half,
                                          const LocatedBars& bars, const SymbolLayout& layout,
                                          const LensGuess& lens = {});

// The frame fitted again around a symbol that was read: `expected` is where its bars put the
// frame's corners, clockwise from P. Sides that are not found there count as hidden. Nothing where
// neither the picture nor the bars' ends place the upper or the lower side.
std::optional<RefinedFrame> frame_by_symbol(const GrayView& image, const GrayView& half,
                                            const Quad& expected, const SymbolLayout& layout,
                                            double module_px, const LensGuess& lens = {});

}  // namespace tagsmith::detail
