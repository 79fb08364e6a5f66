// SPDX-License-Identifier: Apache-2.0
// Whole pictures copied, turned, reduced or with black and white exchanged.
#pragma once

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// ---- Stored pictures as they must be shown.

// How a stored picture becomes upright: EXIF orientation 1 to 8 (CIPA DC-008, Orientation).
struct Upright {
  int orientation = 1;
  int width = 0;  // as stored, pixels
  int height = 0;

  // True for the orientations that mirror: what is stored is seen from behind.
  bool mirrors() const;

  // Width and height of the stored picture are exchanged.
  bool transposes() const { return orientation >= 5; }

  // After transposing: left for right, up for down.
  bool reverses_rows() const;
  bool reverses_columns() const;

  // The place of a stored pixel in the upright picture.
  PixelPoint turn(PixelPoint at) const;
};

// The picture, or a part of it, as it must be shown.
GrayImage turn_upright(const GrayView& stored, int orientation);

// ---- Copies.

// The image, or a part of one, with samples of its own.
GrayImage copy_of(const GrayView& image);

// ---- Smaller pictures.

// The image at half its size, each pixel the mean of four; an odd last row or column is dropped.
GrayImage half_size(const GrayView& image);

// The image with neither side longer than `most` pixels: each pixel the mean of a square of as few
// as that takes, but none wider than the image is high, or higher than it is wide. Last rows and
// columns that fill no square are dropped.
GrayImage shrunk_to(const GrayView& image, int most);

// ---- Negatives.

// Black for white, sample by sample; the negative of a negative is the picture.
GrayImage exchange_black_and_white(const GrayView& image);

// ---- Tone.

// A picture whose samples are in proportion to light, as those of many cameras for machines are:
// with the samples that sRGB has for that light.
GrayImage linear_as_srgb(const GrayView& image);

}  // namespace tagsmith::detail
