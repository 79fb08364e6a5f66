// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/bar_texture.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include "decoder/feature_frame/tile_threshold.hpp"

namespace tagsmith {
namespace {

constexpr int kRowStep = 2;

// Texture of the first `columns` columns of a tile whose upper left pixel `samples` points to.
Texture tile_texture(const std::uint8_t* samples, std::ptrdiff_t stride, int columns = kTile) {
  int right = 0, down = 0, falling = 0, rising = 0;
  for (int row = 0; row < kTile; row += kRowStep) {
    const std::uint8_t* here = samples + row * stride;
    const std::uint8_t* below = here + stride;
    for (int x = 0; x < columns; ++x) {
      right += std::abs(here[x] - here[x + 1]);
      down += std::abs(here[x] - below[x]);
      falling += std::abs(here[x] - below[x + 1]);
      rising += std::abs(here[x + 1] - below[x]);
    }
  }
  return {static_cast<std::uint16_t>(right), static_cast<std::uint16_t>(down),
          static_cast<std::uint16_t>(falling), static_cast<std::uint16_t>(rising)};
}

#if defined(__SSE2__)
using Chars = char __attribute__((vector_size(16)));
using Words = std::uint64_t __attribute__((vector_size(16)));

Chars load(const std::uint8_t* from) {
  Chars samples;
  std::memcpy(&samples, from, sizeof samples);
  return samples;
}

// Sums of the absolute differences of either eight bytes, which the compiler has no portable word
// for.
Words differences(Chars a, Chars b) {
  return reinterpret_cast<Words>(__builtin_ia32_psadbw128(a, b));
}

// Textures of two tiles side by side.
void two_tile_textures(const std::uint8_t* samples, std::ptrdiff_t stride, Texture* textures) {
  static_assert(kTile == 8 && sizeof(Texture) == 8);
  Words right{}, down{}, falling{}, rising{};
  for (int row = 0; row < kTile; row += kRowStep) {
    const std::uint8_t* from = samples + row * stride;
    const Chars here = load(from), here_right = load(from + 1);
    const Chars below = load(from + stride), below_right = load(from + stride + 1);
    right += differences(here, here_right);
    down += differences(here, below);
    falling += differences(here, below_right);
    rising += differences(here_right, below);
  }
  const Words both = right | down << 16 | falling << 32 | rising << 48;
  std::memcpy(static_cast<void*>(textures), &both, sizeof both);
}
#else
void two_tile_textures(const std::uint8_t* samples, std::ptrdiff_t stride, Texture* textures) {
  textures[0] = tile_texture(samples, stride);
  textures[1] = tile_texture(samples + kTile, stride);
}
#endif

// The directions of gradients are told apart to an eighth of a half turn.
constexpr int kDirections = 8;

// Steps from tile to tile in these directions: (0, 0) to the third.
constexpr int kReach = 3;
using Steps = std::array<std::array<int, 2>, kReach + 1>;
constexpr std::array<Steps, kDirections> kSteps{{{{{0, 0}, {1, 0}, {2, 0}, {3, 0}}},
                                                 {{{0, 0}, {1, 0}, {2, 1}, {3, 1}}},
                                                 {{{0, 0}, {1, 1}, {2, 2}, {3, 3}}},
                                                 {{{0, 0}, {0, 1}, {1, 2}, {1, 3}}},
                                                 {{{0, 0}, {0, 1}, {0, 2}, {0, 3}}},
                                                 {{{0, 0}, {0, 1}, {-1, 2}, {-1, 3}}},
                                                 {{{0, 0}, {-1, 1}, {-2, 2}, {-3, 3}}},
                                                 {{{0, 0}, {-1, 0}, {-2, 1}, {-3, 1}}}}};

// The eighth of a turn around whose middle the vector points.
int octant_of(int x, int y) {
  constexpr int kSteep = 618;  // 256 tan(67.5 degrees)
  const int across = std::abs(x), down = std::abs(y);
  if (256 * down > kSteep * across) return y > 0 ? 2 : 6;
  if (256 * across > kSteep * down) return x > 0 ? 0 : 4;
  return x > 0 ? (y > 0 ? 1 : 7) : (y > 0 ? 3 : 5);
}

// The directions of tiles, with a margin all around that has none.
class DirectionGrid {
 public:
  explicit DirectionGrid(const TextureGrid& texture, std::span<const Quad> known)
      : columns_(texture.columns),
        rows_(texture.rows),
        stride_(texture.columns + 2 * kReach),
        alike_(static_cast<std::size_t>(stride_ * (rows_ + 2 * kReach))),
        octants_(alike_.size()) {
    constexpr int kLeastStrength = 200;  // 6 grey levels from pixel to pixel
    const Texture* tile = texture.tiles.data();
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column, ++tile) {
        const Gradient gradient = gradient_of(*tile);
        if (is_directed(gradient, kLeastStrength))
          set(index(column, row), octant_of(gradient.cos2, gradient.sin2));
      }
      for (const Quad& quad : known) clear(quad, row);
    }
  }

  // Whether the tile lies in a field: most tiles in its gradient's direction have that direction
  // too. The least readable symbols are four tiles long, joints of brickwork two tiles wide.
  bool is_in_field(int column, int row) const {
    constexpr int kLeast = 4;
    const std::size_t at = index(column, row);
    if (alike_[at] == 0) return false;
    const unsigned octant = octants_[at];
    int count = 1;
    for (std::size_t i = 1; i <= kReach; ++i) {
      const auto [x, y] = kSteps[octant][i];
      const auto step = static_cast<std::size_t>(y * stride_ + x);
      count +=
          static_cast<int>((alike_[at + step] >> octant & 1U) + (alike_[at - step] >> octant & 1U));
    }
    return count >= kLeast;
  }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>((row + kReach) * stride_ + column + kReach);
  }

  void set(std::size_t at, int octant) {
    octants_[at] = static_cast<std::uint8_t>(octant);
    const unsigned near = 0b10000011U << static_cast<unsigned>(octant);
    alike_[at] = static_cast<std::uint8_t>(near | near >> 8U);
  }

  void clear(const Quad& quad, int row) {
    const auto [begin, end] = tiles_in_row(quad, row, columns_);
    for (int column = begin; column < end; ++column) alike_[index(column, row)] = 0;
  }

  int columns_;
  int rows_;
  int stride_;
  std::vector<std::uint8_t> alike_;    // a bit for each octant that is the tile's or next to it
  std::vector<std::uint8_t> octants_;  // where the tile has a direction
};

// Adds the tiles up to `reach` tiles from those of the mask, across and down.
void widen(TileMask& mask, int reach) {
  const auto columns = static_cast<std::size_t>(mask.columns);
  const auto margin = static_cast<std::size_t>(reach);
  std::vector<std::uint8_t> wide(mask.tiles.size());
  std::vector<std::uint8_t> padded(columns + 2 * margin);
  for (std::size_t row = 0; row < static_cast<std::size_t>(mask.rows); ++row) {
    std::copy_n(mask.tiles.data() + row * columns, columns, padded.data() + margin);
    std::uint8_t* __restrict to = wide.data() + row * columns;
    for (std::size_t shift = 0; shift <= 2 * margin; ++shift) {
      const std::uint8_t* from = padded.data() + shift;
      for (std::size_t x = 0; x < columns; ++x) to[x] |= from[x];
    }
  }
  for (int row = 0; row < mask.rows; ++row) {
    std::uint8_t* __restrict to = mask.tiles.data() + static_cast<std::size_t>(row) * columns;
    for (int near = std::max(0, row - reach); near <= std::min(mask.rows - 1, row + reach);
         ++near) {
      const std::uint8_t* from = wide.data() + static_cast<std::size_t>(near) * columns;
      for (std::size_t x = 0; x < columns; ++x) to[x] |= from[x];
    }
  }
}

}  // namespace

TextureGrid texture_of(const GrayView& image) {
  TextureGrid grid;
  grid.columns = (image.width + kTile - 1) / kTile;
  grid.rows = (image.height + kTile - 1) / kTile;
  grid.tiles.resize(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows));
  for (int row = 0; (row + 1) * kTile <= image.height; ++row) {
    const std::uint8_t* samples = image.row(row * kTile);
    Texture* textures =
        grid.tiles.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns);
    int x = 0;
    for (; x + 2 * kTile < image.width; x += 2 * kTile) {
      two_tile_textures(samples + x, image.stride, textures + x / kTile);
    }
    for (; x + kTile <= image.width; x += kTile) {
      const int columns = std::min(kTile, image.width - 1 - x);  // the last has no right neighbour
      textures[x / kTile] = tile_texture(samples + x, image.stride, columns);
    }
  }
  return grid;
}

// Where a gradient has the angle a, right - down is its length by |cos a| - |sin a|, and falling -
// rising the same by sin 2a / max(|cos a|, |sin a|): 1.41 times as much at 45 degrees, hence the
// factor.
Gradient gradient_of(const Texture& t) {
  constexpr int kDiagonal = 181;  // 256 / sqrt(2)
  return {t.right - t.down, (t.falling - t.rising) * kDiagonal / 256,
          (t.right + t.down + (t.falling + t.rising) * kDiagonal / 256) / 2};
}

// Bars give 0.6 to 0.8 of the strength, isotropic noise next to nothing.
bool is_directed(const Gradient& gradient, int least_strength) {
  constexpr int kShare = 4;  // 1 / the least share of the strength
  return gradient.strength >= least_strength &&
         kShare * kShare * (gradient.cos2 * gradient.cos2 + gradient.sin2 * gradient.sin2) >
             gradient.strength * gradient.strength;
}

TileMask tiles_near_bars(const TextureGrid& texture, std::span<const Quad> known) {
  constexpr int kAround = 5;  // tiles: quiet zone and stroke, 14 modules of 2.8 pixels
  TileMask mask{texture.columns, texture.rows, std::vector<std::uint8_t>(texture.tiles.size())};
  const DirectionGrid directions(texture, known);
  auto tile = mask.tiles.begin();
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.columns; ++column, ++tile) {
      *tile = directions.is_in_field(column, row) ? 1 : 0;
    }
  }
  widen(mask, kAround);
  return mask;
}

}  // namespace tagsmith
