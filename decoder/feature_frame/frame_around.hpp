// SPDX-License-Identifier: Apache-2.0
// The feature frame around a field of bars.
#pragma once

#include <optional>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// Searches outwards from the bars for the straight edges from white to dark that surround them,
// each visible over about half of its length; what covers the rest does not matter. The inner edge
// of the frame, clockwise in the image, to a pixel or two; nothing when a side is not visible.
std::optional<Quad> frame_around(const GrayView& image, const BarRegion& block);

// The frame whose left and right sides are known (of the block as it stands: upwards on the left,
// downwards on the right), with the upper and lower sides, each shown by two fifths of its length,
// that suit the bars' ends best.
std::optional<Quad> frame_between(const GrayView& image, const BarRegion& block,
                                  const SideLine& left, const SideLine& right);

}  // namespace tagsmith::detail
