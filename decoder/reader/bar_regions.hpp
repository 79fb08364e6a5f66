// SPDX-License-Identifier: Apache-2.0
// Where parallel bars may be, framed or not.
#pragma once

#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/image/pixel.hpp"

namespace tagsmith {

// A patch of the image whose edges all run one way, in pixels of the image.
struct BarRegion {
  PixelPoint centre;
  PixelPoint across;  // unit vector across the bars, along the symbol
  double length = 0;  // extent across the bars
  double height = 0;  // extent along the bars
};

// Patches of one direction, largest first, at most `most`: from the coherence of the gradients'
// structure tensor (Bigun and Granlund 1987) over cells of 8 pixels, at several reductions of the
// image so that modules from half a pixel to some ten pixels fill the cells. Images of more than
// two million pixels are searched reduced, so that modules below about one pixel of the reduced
// image are missed.
std::vector<BarRegion> find_bar_regions(const GrayView& image, std::size_t most);

// Before these as many others: patches that only hang together by thin necks are several, and each
// is a cell smaller on all sides.
std::vector<BarRegion> find_bar_regions_apart(const GrayView& image, std::size_t most);

}  // namespace tagsmith
