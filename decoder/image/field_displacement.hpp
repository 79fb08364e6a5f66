// SPDX-License-Identifier: Apache-2.0
// The two fields of an interlaced picture.
#pragma once

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

inline constexpr int kMostFieldDisplacement = 8;  // pixels

// By how many pixels what the even and the odd rows of an image show is displaced along the rows:
// an interlaced camera takes them one after the other, and between them it or the object moved. The
// border of that width at both sides is only compared with. 0 where a single exposure explains the
// rows.
double field_displacement(const GrayView& image);

}  // namespace tagsmith::detail
