// SPDX-License-Identifier: Apache-2.0
// Pictures as the library takes them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tagsmith {

// Borrowed 8-bit grey samples, row by row, the upper left one first: luma as stored, not turned by
// any note of the camera, since calibrations refer to the sensor. The samples must stay until the
// function that takes the view returns. At most 200 million pixels.
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width = 0;              // pixels
  int height = 0;             // pixels
  std::ptrdiff_t stride = 0;  // bytes from one row to the next; 0 = the width
};

}  // namespace tagsmith
