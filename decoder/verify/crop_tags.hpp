// SPDX-License-Identifier: Apache-2.0
// Pictures of faults, for people.
#pragma once

#include <optional>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/verify/verified_file.hpp"

namespace tagsmith::detail {

// The part of the picture within these corners and half a frame's size more on each side, at most
// 800 pixels wide, turned upright by the picture's EXIF `orientation`.
std::optional<GrayImage> crop_around(const GrayView& image, const FrameCorners& corners,
                                     int orientation);

// Fills `picture.image` of every fault. Tags that already have an image or a file of it keep it.
void crop_faults(const GrayView& image, std::vector<VerifiedTag>& tags, int orientation);

// The whole picture, no side of it longer than 480 pixels, turned upright.
GrayImage small_picture(const GrayView& image, int orientation);

}  // namespace tagsmith::detail
