// SPDX-License-Identifier: Apache-2.0
// Regions of parallel bars, framed or not, found by their texture alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/tile_threshold.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// ---- Which way bars run inside a quadrilateral.

// How much the grey level changes along the sides 0 and 2 (`along`) and along the sides 1 and 3
// (`across`), averaged over the other direction so that only bars that run through count: mean
// absolute step between neighbouring places, grey levels.
struct BarSteps {
  double along = 0;
  double across = 0;
};

BarSteps bar_steps(const GrayView& image, const Quad& quad);

// ---- Where in an image there may be bars: a check of every tile that costs less than reading it
// once.

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

// Where a gradient has the angle a, right - down is its length by |cos a| - |sin a|, and falling -
// rising the same by sin 2a / max(|cos a|, |sin a|): 1.41 times as much at 45 degrees, hence the
// factor.
inline Gradient gradient_of(const Texture& t) {
  constexpr int kDiagonal = 181;  // 256 / sqrt(2)
  return {t.right - t.down, (t.falling - t.rising) * kDiagonal / 256,
          (t.right + t.down + (t.falling + t.rising) * kDiagonal / 256) / 2};
}

// Whether a tile's gradients are of at least this strength and of one direction, as bars are: bars
// give 0.6 to 0.8 of the strength, isotropic noise almost nothing.
inline bool is_directed(const Gradient& gradient, int least_strength) {
  constexpr int kShare = 4;  // 1 / the least share of the strength
  const int directed = gradient.cos2 * gradient.cos2 + gradient.sin2 * gradient.sin2;
  const bool is_strong = gradient.strength >= least_strength;
  const bool is_one = kShare * kShare * directed > gradient.strength * gradient.strength;
  return is_strong & is_one;  // without a branch: for all tiles of an image
}

// The tiles in and around fields of parallel bars of up to two or three pixels a module: as far as
// a feature frame around such bars reaches. Left out are bars in the parts that are `known`, edges
// of walls and pipes, whose tiles are not followed by others in the direction of their gradient,
// and texture without a direction.
TileMask tiles_near_bars(const TextureGrid& texture, std::span<const Quad> known = {});

// Unit: the direction of most gradients of the tiles in a quadrilateral of the image.
PixelPoint main_gradient(const GrayView& image, const Quad& quad);

// ---- Regions of parallel bars.

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

// Whether two regions are the same bars, as two levels or two frames show them.
bool same_bars(const BarRegion& a, const BarRegion& b);

// Whether the first or the last bar is so near the image's border that the symbol may continue
// beyond it.
bool runs_off(const GrayView& image, const BarRegion& region);

// The regions of an image outside the parts that are `known`: connected tiles whose gradients,
// summed with those of the tiles around, agree on one direction. Tiles at the edge of a region are
// left out, so that regions that are connected only by the edge of a plate or of a cable are
// separated. The extent is accurate to a tile.
std::vector<BarRegion> find_bar_regions(const TextureGrid& texture,
                                        std::span<const Quad> known = {});

}  // namespace tagsmith::detail
