// SPDX-License-Identifier: Apache-2.0
// Where parallel bars may be, framed or not.
#pragma once

#include <cstddef>
#include <memory>
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

// Finds patches of one direction from the coherence of the gradients' structure tensor (Bigun and
// Granlund 1987) over cells of 8 pixels, at several reductions of the image so that modules from
// half a pixel to some ten pixels fill the cells. Images of more than two million pixels are
// searched reduced, so that modules below about one pixel of the reduced image are missed. What was
// found is kept for who asks next. The image's samples must outlive it.
class BarRegions {
 public:
  explicit BarRegions(const GrayView& image);
  BarRegions(BarRegions&&) noexcept;
  BarRegions& operator=(BarRegions&&) noexcept;
  ~BarRegions();

  // The patches, largest first, at most `most` of them.
  std::vector<BarRegion> whole(std::size_t most);

  // Patches that only hang together by thin necks taken apart, each a cell smaller on all sides;
  // largest first, at most `most` of them.
  std::vector<BarRegion> apart(std::size_t most);

 private:
  struct Cells;

  std::vector<BarRegion> first_of(bool apart, std::size_t most);

  GrayView image_;
  std::unique_ptr<Cells> cells_;  // made when they are first wanted
};

}  // namespace tagsmith
