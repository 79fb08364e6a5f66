// SPDX-License-Identifier: Apache-2.0
// Fields of parallel bars, found by their texture alone: where a symbol is although its frame does
// not show as one piece.
#pragma once

#include <span>
#include <vector>

#include "decoder/feature_frame/bar_texture.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith {

// A field of bars as a rectangle turned into the direction in which they follow each other.
struct BarBlock {
  PixelPoint centre;
  PixelPoint across;  // unit, from bar to bar
  PixelPoint along;   // unit, along the bars: a quarter turn clockwise (in the image) from across
  double half_width = 0;   // across, pixels
  double half_height = 0;  // along
};

// The same block in an image of this many times the size (pixel centres shift by half of that).
BarBlock scaled(const BarBlock& block, double scale);

// Whether the first or the last bar of the block is at the image's border, to about a tile.
bool runs_off(const GrayView& image, const BarBlock& block);

// Whether the grey level changes much from bar to bar and little along them, in the middle of the
// block: what a wall's texture, pipes and edges of plates fail.
bool is_symbol_like(const GrayView& image, const BarBlock& block);

// The blocks of an image outside the parts that are `known`, the largest first: connected tiles
// whose gradients agree on one direction, and pairs of such blocks that something in front keeps
// apart. Their extent is good to a tile.
std::vector<BarBlock> find_bar_blocks(const TextureGrid& texture, std::span<const Quad> known);

}  // namespace tagsmith
