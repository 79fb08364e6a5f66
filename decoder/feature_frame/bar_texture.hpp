// SPDX-License-Identifier: Apache-2.0
// Where in an image there may be bars: a look at every tile that costs less than reading it once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/tile_threshold.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith {

// Sums over a tile of the absolute differences between neighbouring pixels, of every other row.
struct Texture {
  std::uint16_t right = 0;    // to the pixel on the right
  std::uint16_t down = 0;     // to the one below
  std::uint16_t falling = 0;  // to the one below on the right
  std::uint16_t rising = 0;   // from the one below to the one on the right
};

// The textures of an image's tiles (kTile pixels square), row by row; those of tiles that the
// border cuts are zero.
struct TextureGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Texture> tiles;
};

TextureGrid texture_of(const GrayView& image);

// The direction of a tile's gradients, as a vector of the doubled angle, which makes opposite
// gradients one; and their strength whatever the direction.
struct Gradient {
  int cos2 = 0;
  int sin2 = 0;
  int strength = 0;
};

Gradient gradient_of(const Texture& texture);

// Whether a tile's gradients are of at least this strength and of one direction, as bars are.
bool is_directed(const Gradient& gradient, int least_strength);

// The tiles in and around fields of parallel bars of up to two or three pixels a module: as far as
// a feature frame around such bars reaches. Left out are bars in the parts that are `known`, edges
// of walls and pipes, whose tiles are not followed by others in the direction of their gradient,
// and texture without a direction.
TileMask tiles_near_bars(const TextureGrid& texture, std::span<const Quad> known = {});

}  // namespace tagsmith
