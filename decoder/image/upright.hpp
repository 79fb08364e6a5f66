// SPDX-License-Identifier: Apache-2.0
// Stored pictures as they are to be shown.
#pragma once

#include "decoder/image/gray.hpp"
#include "decoder/image/pixel.hpp"

namespace tagsmith::detail {

// How a stored picture becomes upright: EXIF orientation 1 to 8 (CIPA DC-008, Orientation).
struct Upright {
  int orientation = 1;
  int width = 0;  // as stored, pixels
  int height = 0;

  // True for the orientations that mirror: what is stored is seen from behind.
  bool mirrors() const;

  // The stored picture's sides change places.
  bool transposes() const { return orientation >= 5; }

  // After transposing: left for right, up for down.
  bool reverses_rows() const;
  bool reverses_columns() const;

  // Where a stored pixel comes to lie.
  PixelPoint turn(PixelPoint at) const;
};

// The picture, or a part of it, as it is to be shown.
GrayImage turn_upright(const GrayView& stored, int orientation);

}  // namespace tagsmith::detail
