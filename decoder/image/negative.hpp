// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// Black for white, sample by sample; the negative of a negative is the picture.
GrayImage exchange_black_and_white(const GrayView& image);

}  // namespace tagsmith::detail
