// SPDX-License-Identifier: Apache-2.0
// Prints as if with more or less ink.
#pragma once

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// The image with everything dark so many pixels wider and higher, or, negative, narrower. The image
// must not be empty.
GrayImage grow_ink(const GrayView& image, int pixels);

}  // namespace tagsmith::detail
