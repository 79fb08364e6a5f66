// SPDX-License-Identifier: Apache-2.0
// White and dark regions of an image: local threshold, runs, connected regions.
#pragma once

#include <cstdint>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/image/pixel.hpp"

namespace tagsmith {

struct RegionOptions {
  // Side of the square tiles whose darkest and brightest samples set the local threshold, pixels.
  // The threshold sees 3 x 3 tiles, so an edge is found wherever both its sides lie within about
  // two tiles; 8 keeps bars and quiet zones of the smallest readable tags apart from the wall.
  int tile = 8;
  // A neighbourhood whose contrast is less than this many grey levels is flat, and white.
  int min_contrast = 20;
  // Regions smaller than this, in pixels across and down, cannot hold a readable symbol.
  int min_width = 20;
  int min_height = 12;
};

// A connected region of one colour and the ends of its extent on each of its rows.
struct Region {
  bool white = false;
  int left = 0;
  int top = 0;
  int right = 0;   // inclusive
  int bottom = 0;  // inclusive
  std::int64_t area = 0;
  std::vector<PixelPoint> outline;  // leftmost and rightmost pixel of each row, top to bottom
};

// The white (4-connected) and dark (8-connected) regions that are at least as large as the options
// ask, those that touch the image's border included.
std::vector<Region> find_regions(const GrayView& image, const RegionOptions& options = {});

}  // namespace tagsmith
