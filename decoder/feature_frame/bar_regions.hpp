// SPDX-License-Identifier: Apache-2.0
// Regions of parallel bars, framed or not, found by their texture alone.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "decoder/feature_frame/bar_texture.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// A rectangle full of bars, turned into the direction in which they follow each other, in pixels.
struct BarRegion {
  PixelPoint centre;
  PixelPoint across;  // unit, from bar to bar: along the symbol
  double length = 0;  // extent across the bars
  double height = 0;  // extent along the bars

  // Unit, along the bars: a quarter turn clockwise (in the image) from `across`.
  PixelPoint along() const { return {-across.y, across.x}; }
};

// The same region in an image of this many times the size (pixel centres shift by half of that).
BarRegion scaled(const BarRegion& region, double scale);

// Whether the first or the last bar is so near the image's border that the symbol may go on
// beyond it.
bool runs_off(const GrayView& image, const BarRegion& region);

// The regions of an image outside the parts that are `known`: connected tiles whose gradients,
// taken together with those of the tiles around, agree on one direction. Tiles at the edge of a
// region are left out, so that regions that hang together by the edge of a plate or of a cable come
// apart. The extent is good to a tile.
std::vector<BarRegion> find_bar_regions(const TextureGrid& texture,
                                        std::span<const Quad> known = {});

}  // namespace tagsmith::detail
