// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "decoder/image/gray.hpp"
#include "decoder/reader/reading.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// How it is seen that a tag is a mirrored print; empty when it is not. A UPC-A symbol mirrored has
// the bars of the same symbol upside down, so its bars cannot tell. The label can: it stands below
// the frame as the bars are read, and above it in a mirrored print. Told where that place is white
// and ink stands in the opposite one, from 4 px a module on. Where the frame stands 5 mm and more
// above or below the plate's middle, the plate's edges tell the same from 2 px a module on, before
// a dark ground.
std::string find_mirroring(const GrayView& image, const TagTemplate& tag,
                           const FrameCorners& corners, double module_px);

}  // namespace tagsmith::detail
