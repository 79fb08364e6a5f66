// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// The image at half its size, each pixel the mean of four; an odd last row or column is dropped.
GrayImage half_size(const GrayView& image);

}  // namespace tagsmith::detail
