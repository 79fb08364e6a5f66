// SPDX-License-Identifier: Apache-2.0
// Outlines that lines which cross have between them, as the wires of a mesh, and no feature frame.
#pragma once

#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// Whether more than half of the eight ends of a frame's strokes go on beyond the corners as dark
// lines: of a frame that lies between two, as runs of paint may be, half do. A printed stroke ends
// there, in the white margin of its plate.
bool lies_between_crossing_lines(const GrayView& image, const RefinedFrame& frame,
                                 const FrameShape& shape = {});

}  // namespace tagsmith::detail
