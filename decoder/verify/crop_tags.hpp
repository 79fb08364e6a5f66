// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/verify/finding.hpp"

namespace tagsmith {

// Fills `crop` of every fault: the tag and half a frame's size more on each side, at most 800
// pixels wide, turned upright by the picture's EXIF `orientation`. Tags that have a crop or a file
// of one keep it.
void crop_faults(const GrayView& image, std::vector<TagFinding>& tags, int orientation = 1);

// The whole picture, no side of it longer than 480 pixels, turned upright.
GrayImage small_picture(const GrayView& image, int orientation = 1);

}  // namespace tagsmith
