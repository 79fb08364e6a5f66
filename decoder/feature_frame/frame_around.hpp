// SPDX-License-Identifier: Apache-2.0
// The feature frame around a field of bars.
#pragma once

#include <optional>

#include "decoder/feature_frame/bar_blocks.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith {

// Looks outwards from the bars for the straight edges from white to dark that surround them, each
// shown by about half of its length; what covers the rest does not matter. The inner edge of the
// frame, clockwise in the image, to a pixel or two; nothing when a side does not show.
std::optional<Quad> frame_around(const GrayView& image, const BarBlock& block);

}  // namespace tagsmith
