// SPDX-License-Identifier: Apache-2.0
// How the point spread, one in pixels, varies along a symbol that is seen obliquely.
#pragma once

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "decoder/scan/profile.hpp"

namespace tagsmith::detail {

// Sets ScanBin::spread from the widths, across the bars, that modules have in the image at half the
// frame's height. `image_from_frame` maps the unit square to the frame's inner edge, P at (0, 0).
void set_spreads(const FrameHomography& image_from_frame, const SymbolLayout& layout,
                 ScanProfile& profile);

}  // namespace tagsmith::detail
