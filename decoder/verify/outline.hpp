// SPDX-License-Identifier: Apache-2.0
// Places of tags in a picture.
#pragma once

#include "decoder/reader/reading.hpp"

namespace tagsmith {

// True when the middle of one convex outline lies in the other: they are of one tag.
bool overlap(const FrameCorners& a, const FrameCorners& b);

}  // namespace tagsmith
