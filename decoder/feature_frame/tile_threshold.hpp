// SPDX-License-Identifier: Apache-2.0
// A threshold for every tile of an image, and the pixels below it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// Side of the square tiles, pixels. The threshold sees 3 x 3 tiles, so an edge is found wherever
// both its sides lie within about two tiles; 8 keeps bars and quiet zones of the smallest readable
// tags apart from the wall, and a tile's row is one 64-bit word.
inline constexpr int kTile = 8;

// Darkest and brightest sample of each tile; grids of columns x rows tiles, row by row. The tiles
// at the right and lower border may be cut.
struct TileExtremes {
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> low;
  std::vector<std::uint8_t> high;
};

// A flag for each tile of an image, row by row.
struct TileMask {
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> tiles;  // 0 or 1
};

// With a mask of the image's tiles only those of the mask, and some beside them, are computed; the
// others get 255 and 0, so that no neighbour is darker or brighter.
TileExtremes tile_extremes(const GrayView& image, const TileMask* searched = nullptr);

// Per tile, a threshold and how much the 3 x 3 tiles around it differ; grids as those of the
// extremes.
struct TileThresholds {
  int columns = 0;
  std::vector<std::uint8_t> levels;  // grey level below which a sample is dark; 0 where it is flat
  std::vector<std::uint8_t> contrast;  // grey levels between darkest and brightest
};

// The threshold is midway between the extremes of the 3 x 3 tiles around; where these differ by
// less than `min_contrast`, the tile is flat and nothing in it is dark.
TileThresholds tile_thresholds(const TileExtremes& extremes, int min_contrast);

// Makes the tiles flat that are not in the mask.
void keep_tiles(const TileMask& searched, TileThresholds& thresholds);

// The tiles of a row whose centres lie in a convex quadrilateral: begin and end of their columns,
// within `columns`.
std::array<int, 2> tiles_in_row(const Quad& quad, int row, int columns);

// Makes the tiles flat whose centre lies in the quadrilateral.
void clear_tiles(const Quad& quad, TileThresholds& thresholds);

// The pixels of an image that are dark: 64 pixels a word, the first in its lowest bit.
struct DarkPixels {
  int width = 0;
  int height = 0;
  std::size_t words = 0;  // of a row
  std::vector<std::uint64_t> bits;
  // For every row of tiles the words that may hold dark pixels: begin and end.
  std::vector<std::array<std::size_t, 2>> used;

  const std::uint64_t* row(int y) const {
    return bits.data() + static_cast<std::size_t>(y) * words;
  }
};

// Thresholds the image. Where that gives more than `max_changes` changes of colour along its rows,
// the tiles with the least contrast become flat until about so many are left: a frame is among the
// sharpest contrasts in a picture, and texture and noise have no limit.
DarkPixels mark_dark(const GrayView& image, TileThresholds thresholds, std::size_t max_changes);

}  // namespace tagsmith::detail
