// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// The image with neither side longer than `most` pixels: each pixel the mean of a square of as few
// as that takes, but none wider than the image is high, or higher than it is wide. Last rows and
// columns that fill no square are dropped.
GrayImage shrunk_to(const GrayView& image, int most);

}  // namespace tagsmith::detail
