// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "decoder/feature_frame/quad.hpp"

namespace tagsmith::detail {

// Inner corners of the feature frame, clockwise from P: P, F, lower right, Q, as the tag's own
// "up" says (whatever way it is turned in the image).
using FrameCorners = Quad;

}  // namespace tagsmith::detail
