// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/bar_regions.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <optional>
#include <ranges>
#include <utility>

#include "decoder/feature_frame/tuning.hpp"
#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {

// ---- The direction of bars.

namespace {

constexpr std::size_t kProfilePlaces = 80;
constexpr std::size_t kRows = 6;

// Places in the quadrilateral's unit square, inside the quiet zones, that are averaged along v.
struct Places {
  std::array<double, kProfilePlaces> u{};
  std::array<double, kRows> v{};
};

constexpr Places places() {
  Places places;
  for (std::size_t i = 0; i < kProfilePlaces; ++i) {
    places.u[i] = 0.12 + 0.76 * static_cast<double>(i) / (kProfilePlaces - 1);
  }
  for (std::size_t i = 0; i < kRows; ++i) {
    places.v[i] = 0.27 + 0.46 * static_cast<double>(i) / (kRows - 1);
  }
  return places;
}

// Mean step along u where `at(u, v)` is the image's place.
template <class At>
double mean_step(const GrayView& image, const At& at) {
  static constexpr Places kAt = places();
  double before = 0;
  double sum = 0;
  for (std::size_t place = 0; place < kProfilePlaces; ++place) {
    std::array<PixelPoint, kRows> pixels;
    for (std::size_t row = 0; row < kRows; ++row) pixels[row] = at(kAt.u[place], kAt.v[row]);
    double value = 0;
    for (const PixelPoint& pixel : pixels) value += sample_bilinear(image, pixel) / kRows;
    if (place > 0) sum += std::abs(value - before);
    before = value;
  }
  return sum / (kProfilePlaces - 1);
}

}  // namespace

BarSteps bar_steps(const GrayView& image, const Quad& quad) {
  const Homography map = homography_to(quad);
  return {mean_step(image, [&](double u, double v) { return map(u, v); }),
          mean_step(image, [&](double u, double v) { return map(v, u); })};
}

// ---- Regions of bars.

// ---- The texture of tiles.

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
using CharVector = char __attribute__((vector_size(16)));
using Words = std::uint64_t __attribute__((vector_size(16)));

CharVector load(const std::uint8_t* from) {
  CharVector samples;
  std::memcpy(&samples, from, sizeof samples);
  return samples;
}

// Sums the absolute differences of each group of eight bytes; compilers have no portable operation
// for this.
Words differences(CharVector a, CharVector b) {
  return reinterpret_cast<Words>(__builtin_ia32_psadbw128(a, b));
}

// Textures of two tiles side by side.
void two_tile_textures(const std::uint8_t* samples, std::ptrdiff_t stride, Texture* textures) {
  static_assert(kTile == 8 && sizeof(Texture) == 8);
  Words right{}, down{}, falling{}, rising{};
  for (int row = 0; row < kTile; row += kRowStep) {
    const std::uint8_t* from = samples + row * stride;
    const CharVector here = load(from), here_right = load(from + 1);
    const CharVector below = load(from + stride), below_right = load(from + stride + 1);
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

// The directions of gradients are distinguished to an eighth of a half turn.
constexpr std::size_t kDirections = 8;

// Steps to the next tiles in these directions.
constexpr int kReach = 3;
using Steps = std::array<std::array<int, 2>, kReach>;
constexpr std::array<Steps, kDirections> kDirectionSteps{{{{{1, 0}, {2, 0}, {3, 0}}},
                                                          {{{1, 0}, {2, 1}, {3, 1}}},
                                                          {{{1, 1}, {2, 2}, {3, 3}}},
                                                          {{{0, 1}, {1, 2}, {1, 3}}},
                                                          {{{0, 1}, {0, 2}, {0, 3}}},
                                                          {{{0, 1}, {-1, 2}, {-1, 3}}},
                                                          {{{-1, 1}, {-2, 2}, {-3, 3}}},
                                                          {{{-1, 0}, {-2, 1}, {-3, 1}}}}};

// The value of a tile in the grid of directions: 0 = no direction, otherwise one more than the
// octant around whose middle its gradient points.
using Direction = std::uint8_t;

// The directions of a row of tiles; without branches, so that the compiler works on several tiles
// at a time.
TAGSMITH_WIDE
void find_directions(const Texture* __restrict tiles, int count, Direction* __restrict directions) {
  constexpr int kSteep = 618;  // 256 tan(67.5 degrees)
  for (int i = 0; i < count; ++i) {
    const Gradient gradient = gradient_of(tiles[i]);
    const int x = gradient.cos2, y = gradient.sin2;
    const int across = std::abs(x), down = std::abs(y);
    const int right = x > 0 ? 1 : 0, below = y > 0 ? 1 : 0;
    const int diagonal = right != 0 ? 8 - 6 * below : 6 - 2 * below;
    const int flat = 256 * across > kSteep * down ? 5 - 4 * right : diagonal;
    const int octant = 256 * down > kSteep * across ? 7 - 4 * below : flat;
    const int directed = is_directed(gradient, kBarRegion.least_tile) ? octant : 0;
    directions[i] = static_cast<Direction>(directed);
  }
}

// The directions of tiles, with a margin all around that has none.
class DirectionGrid {
 public:
  explicit DirectionGrid(const TextureGrid& texture, std::span<const Quad> known)
      : columns_(texture.columns),
        rows_(texture.rows),
        stride_(texture.columns + 2 * kReach + kAtOnce),
        directions_(static_cast<std::size_t>(stride_) *
                    static_cast<std::size_t>(rows_ + 2 * kReach)) {
    for (int row = 0; row < rows_; ++row) {
      find_directions(texture.tiles.data() + static_cast<std::ptrdiff_t>(row) * columns_, columns_,
                      of_row(row));
      for (const Quad& quad : known) clear(quad, row);
    }
    for (std::size_t octant = 0; octant < kDirections; ++octant) {
      for (std::size_t i = 0; i < kDirectionSteps[octant].size(); ++i) {
        const auto [x, y] = kDirectionSteps[octant][i];
        steps_[octant][i] = static_cast<std::ptrdiff_t>(y) * stride_ + x;
      }
    }
  }

  // Marks the tiles of a row that lie in a field.
  void mark_fields(int row, std::uint8_t* marks) const {
    const Direction* tiles = directions_.data() + index(0, row);
    for (int column = 0; column < columns_; column += kAtOnce) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, tiles + column, kAtOnce);
      // The upper bits of the bytes that are not zero; none is more than kDirections.
      eight = (eight + 0x7F7F7F7F7F7F7F7FU) & 0x8080808080808080U;
      for (; eight != 0; eight &= eight - 1) {
        const int at = column + std::countr_zero(eight) / 8;
        marks[at] = is_in_field(tiles + at) ? 1 : 0;
      }
    }
  }

 private:
  static constexpr int kAtOnce = 8;  // tiles; so much is free beside a row

  // Whether a tile with a direction lies in a field: most tiles in its gradient's direction have
  // that direction too. The least readable symbols are four tiles long, joints of brickwork two
  // tiles wide.
  bool is_in_field(const Direction* tile) const {
    // A bit for each octant that is the direction's or next to it.
    constexpr std::array<std::uint8_t, kDirections + 1> kAlike{0,          0b10000011, 0b00000111,
                                                               0b00001110, 0b00011100, 0b00111000,
                                                               0b01110000, 0b11100000, 0b11000001};
    const unsigned octant = *tile - 1U;
    unsigned count = 1;
    for (const std::ptrdiff_t step : steps_[octant]) {
      count += (kAlike[tile[step]] >> octant & 1U) + (kAlike[tile[-step]] >> octant & 1U);
    }
    return count >= kBarRegion.least_row;
  }

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row + kReach) * static_cast<std::size_t>(stride_) +
           static_cast<std::size_t>(column + kReach);
  }

  Direction* of_row(int row) { return directions_.data() + index(0, row); }

  void clear(const Quad& quad, int row) {
    const auto [begin, end] = tiles_in_row(quad, row, columns_);
    std::fill(of_row(row) + begin, of_row(row) + end, Direction{0});
  }

  int columns_;
  int rows_;
  int stride_;
  std::vector<Direction> directions_;
  std::array<std::array<std::ptrdiff_t, kReach>, kDirections>
      steps_{};  // of kDirectionSteps, in the grid
};

// to[x] |= from[x]
TAGSMITH_WIDE
void add_to(std::uint8_t* __restrict to, const std::uint8_t* __restrict from, std::size_t count) {
  for (std::size_t x = 0; x < count; ++x) to[x] |= from[x];
}

// Adds the tiles up to `reach` tiles from those of the mask, across and down.
void widen(TileMask& mask, std::size_t reach) {
  const auto columns = static_cast<std::size_t>(mask.columns);
  const auto rows = static_cast<std::size_t>(mask.rows);
  // Windows of 1, 2, 4, ... tiles from each tile on, the last one as long as the reach requires.
  const std::size_t window = 2 * reach + 1;
  const auto grow = [&](auto&& add) {
    std::size_t size = 1;
    for (; 2 * size <= window; size *= 2) add(size);
    if (size < window) add(window - size);
  };
  std::vector<std::uint8_t> wide((rows + 2 * reach) * columns);
  std::vector<std::uint8_t> from(columns + 2 * reach), to(from.size());
  for (std::size_t row = 0; row < rows; ++row) {
    std::ranges::fill(from, std::uint8_t{0});
    std::copy_n(mask.tiles.data() + row * columns, columns, from.data() + reach);
    grow([&](std::size_t shift) {
      to = from;
      add_to(to.data(), from.data() + shift, from.size() - shift);
      std::swap(from, to);
    });
    std::copy_n(from.data(), columns, wide.data() + (row + reach) * columns);
  }
  // Downwards in place: the rows that a row adds lie below it and are not changed yet.
  grow([&](std::size_t shift) {
    const std::size_t step = shift * columns;
    for (std::size_t at = 0; at + step < wide.size(); at += columns) {
      add_to(wide.data() + at, wide.data() + at + step, columns);
    }
  });
  std::copy_n(wide.data(), rows * columns, mask.tiles.data());
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
    // A row of tiles is several rows of pixels, more than processors prefetch by themselves.
    constexpr int kCacheLine = 64;
    const std::uint8_t* next = image.row(std::min((row + 1) * kTile, image.height - 1));
    for (; x + 2 * kTile < image.width; x += 2 * kTile) {
      const std::uint8_t* below = next + std::ptrdiff_t{kTile} * x;
      __builtin_prefetch(below);
      __builtin_prefetch(below + kCacheLine);
      two_tile_textures(samples + x, image.stride, textures + x / kTile);
    }
    for (; x + kTile <= image.width; x += kTile) {
      const int columns = std::min(kTile, image.width - 1 - x);  // the last has no right neighbour
      textures[x / kTile] = tile_texture(samples + x, image.stride, columns);
    }
  }
  return grid;
}

TileMask tiles_near_bars(const TextureGrid& texture, std::span<const Quad> known) {
  TileMask mask{texture.columns, texture.rows, std::vector<std::uint8_t>(texture.tiles.size())};
  const DirectionGrid directions(texture, known);
  for (int row = 0; row < mask.rows; ++row) {
    directions.mark_fields(row,
                           mask.tiles.data() + static_cast<std::ptrdiff_t>(row) * mask.columns);
  }
  widen(mask, kBarRegion.around);
  return mask;
}

PixelPoint main_gradient(const GrayView& image, const Quad& quad) {
  // Whole tiles around the quadrilateral, and one more of each row: a tile reaches a pixel beyond.
  const auto tiles_around = [](const auto& places, int size) {
    const auto tile_of = [&](double at) {
      return static_cast<int>(std::clamp(at, 0.0, size - 1.0)) / kTile;
    };
    const auto [low, high] = std::ranges::minmax(places);
    const int first = kTile * tile_of(low);
    return std::pair(first, std::min(size, kTile * (tile_of(high) + 2)) - first);
  };
  const auto [left, width] =
      tiles_around(quad | std::views::transform(&PixelPoint::x), image.width);
  const auto [top, height] =
      tiles_around(quad | std::views::transform(&PixelPoint::y), image.height);
  const PixelBox box{left, top, left + width, top + height};
  Quad there = quad;
  for (PixelPoint& corner : there) corner = corner - box.first();
  const TextureGrid texture = texture_of(part_of(image, box));
  double cos2 = 0, sin2 = 0;
  for (int row = 0; row < texture.rows; ++row) {
    const auto [begin, end] = tiles_in_row(there, row, texture.columns);
    const auto tiles = texture.tiles.begin() + static_cast<std::ptrdiff_t>(row) * texture.columns;
    for (const Texture& tile : std::ranges::subrange(tiles + begin, tiles + std::max(begin, end))) {
      const Gradient gradient = gradient_of(tile);
      cos2 += gradient.cos2;
      sin2 += gradient.sin2;
    }
  }
  const double angle = std::atan2(sin2, cos2) / 2;
  return {std::cos(angle), std::sin(angle)};
}

// ---- Regions of parallel bars.

namespace {

// The gradients of a tile and of those around it.
struct TileGradient {
  float strength = 0;  // whatever the direction
  float cos2 = 0;      // a vector of twice the angle
  float sin2 = 0;

  float squared_length() const { return cos2 * cos2 + sin2 * sin2; }
};

TileGradient operator+(const TileGradient& a, const TileGradient& b) {
  return {a.strength + b.strength, a.cos2 + b.cos2, a.sin2 + b.sin2};
}

bool same_direction(const TileGradient& a, const TileGradient& b) {
  const float product = a.cos2 * b.cos2 + a.sin2 * b.sin2;
  return product > 0 && product * product > kBarRegion.least_cosine * kBarRegion.least_cosine *
                                                a.squared_length() * b.squared_length();
}

bool is_barred(const TileGradient& gradient) {
  constexpr float kTiles = 9;
  const float directed = kBarRegion.least_share * gradient.strength;
  return gradient.strength > kTiles * kBarRegion.least_strength &&
         gradient.squared_length() > directed * directed;
}

// The tiles of an image with a margin of one around them, so that each has its neighbours.
struct BarredTiles {
  explicit BarredTiles(const TextureGrid& texture)
      : columns(texture.columns),
        rows(texture.rows),
        stride(columns + 2),
        gradients(static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows + 2)),
        open(gradients.size()) {}

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(stride) +
           static_cast<std::size_t>(column + 1);
  }

  int columns;
  int rows;
  int stride;
  std::vector<TileGradient> gradients;
  std::vector<std::uint8_t> open;  // tiles of bars that belong to no cluster yet
};

// Each tile's gradients; none in the parts that are known.
void add_gradients(const TextureGrid& texture, std::span<const Quad> known, BarredTiles& tiles) {
  for (int row = 0; row < tiles.rows; ++row) {
    const auto first = tiles.gradients.begin() + static_cast<std::ptrdiff_t>(tiles.index(0, row));
    std::transform(texture.tiles.begin() + static_cast<std::ptrdiff_t>(row) * tiles.columns,
                   texture.tiles.begin() + static_cast<std::ptrdiff_t>(row + 1) * tiles.columns,
                   first, [](const Texture& tile) {
                     const Gradient gradient = gradient_of(tile);
                     return TileGradient{static_cast<float>(gradient.strength),
                                         static_cast<float>(gradient.cos2),
                                         static_cast<float>(gradient.sin2)};
                   });
    for (const Quad& quad : known) {
      const auto [begin, end] = tiles_in_row(quad, row, tiles.columns);
      std::fill(first + begin, first + end, TileGradient{});
    }
  }
}

// Sums each tile's gradients with those of its neighbours at this distance in the grid.
void add_neighbours(std::vector<TileGradient>& gradients, std::size_t step) {
  const std::vector<TileGradient> from = gradients;
  for (std::size_t i = step; i + step < from.size(); ++i) {
    gradients[i] = from[i - step] + from[i] + from[i + step];
  }
}

BarredTiles barred_tiles(const TextureGrid& texture, std::span<const Quad> known) {
  BarredTiles tiles(texture);
  const auto stride = static_cast<std::size_t>(tiles.stride);
  add_gradients(texture, known, tiles);
  add_neighbours(tiles.gradients, 1);
  add_neighbours(tiles.gradients, stride);
  std::vector<std::uint8_t> barred(tiles.open.size());
  for (int row = 0; row < tiles.rows; ++row) {
    for (int column = 0; column < tiles.columns; ++column) {
      const std::size_t i = tiles.index(column, row);
      barred[i] = is_barred(tiles.gradients[i]) ? 1 : 0;
    }
  }
  for (std::size_t i = stride; i + stride < barred.size(); ++i) {
    tiles.open[i] =
        barred[i] & barred[i - 1] & barred[i + 1] & barred[i - stride] & barred[i + stride];
  }
  return tiles;
}

struct Cluster {
  std::vector<PixelPoint> centres;  // of its tiles
  PixelPoint direction;             // twice the angle of the gradient, weighted by strength
};

// Collects the tiles that are connected with this one, diagonal neighbours included.
Cluster grow(BarredTiles& tiles, std::size_t start) {
  Cluster cluster;
  std::vector<std::size_t> queue{start};
  tiles.open[start] = 0;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const std::size_t at = queue[i];
    const TileGradient& gradient = tiles.gradients[at];
    const auto stride = static_cast<std::size_t>(tiles.stride);
    const std::size_t row = at / stride, column = at % stride;
    cluster.centres.push_back({kTile * (static_cast<double>(column) - 0.5) - 0.5,
                               kTile * (static_cast<double>(row) - 0.5) - 0.5});
    cluster.direction = cluster.direction + PixelPoint{static_cast<double>(gradient.cos2),
                                                       static_cast<double>(gradient.sin2)};
    for (const std::size_t beside : {at - stride, at, at + stride}) {
      for (const std::size_t next : {beside - 1, beside, beside + 1}) {
        if (tiles.open[next] == 0 || !same_direction(gradient, tiles.gradients[next])) continue;
        tiles.open[next] = 0;
        queue.push_back(next);
      }
    }
  }
  return cluster;
}

// The rectangle around a cluster; nothing when it is too small for a symbol.
std::optional<BarRegion> region_of(const Cluster& cluster) {
  const double angle = std::atan2(cluster.direction.y, cluster.direction.x) / 2;
  BarRegion region;
  region.across = {std::cos(angle), std::sin(angle)};
  const PixelPoint along = region.along();
  const auto extent = [&](PixelPoint direction) {
    const auto place = [&](PixelPoint centre) { return dot(centre, direction); };
    const auto [low, high] = std::ranges::minmax_element(cluster.centres, {}, place);
    return std::array{place(*low), place(*high)};
  };
  const auto [left, right] = extent(region.across);
  const auto [top, bottom] = extent(along);
  region.centre = (left + right) / 2 * region.across + (top + bottom) / 2 * along;
  region.length = right - left + kTile;
  region.height = bottom - top + kTile;
  return region.length >= kBarRegion.least_length ? std::optional(region) : std::nullopt;
}

}  // namespace

BarRegion scaled(const BarRegion& region, double scale) {
  const double offset = (scale - 1) / 2;
  return {scale * region.centre + PixelPoint{offset, offset}, region.across, scale * region.length,
          scale * region.height};
}

bool same_bars(const BarRegion& a, const BarRegion& b) {
  return distance(a.centre, b.centre) < 0.15 * a.length &&
         std::abs(dot(a.across, b.across)) > 0.97 && a.length < 1.25 * b.length &&
         b.length < 1.25 * a.length;
}

bool runs_off(const GrayView& image, const BarRegion& region) {
  constexpr double kShort = 2 * kTile + 2;  // pixels by which a region may be too short
  const PixelPoint reach = (region.length / 2 + kShort) * region.across;
  const auto outside = [&](PixelPoint at) {
    return at.x < 0 || at.y < 0 || at.x > image.width - 1 || at.y > image.height - 1;
  };
  return outside(region.centre - reach) || outside(region.centre + reach);
}

std::vector<BarRegion> find_bar_regions(const TextureGrid& texture, std::span<const Quad> known) {
  BarredTiles tiles = barred_tiles(texture, known);
  std::vector<Cluster> clusters;
  for (std::size_t i = 0; i < tiles.open.size(); ++i) {
    if (tiles.open[i] == 0) continue;
    clusters.push_back(grow(tiles, i));
  }
  std::ranges::stable_sort(clusters, std::ranges::greater{},
                           [](const Cluster& cluster) { return cluster.centres.size(); });
  std::vector<BarRegion> regions;
  for (const Cluster& cluster : clusters) {
    if (const auto region = region_of(cluster)) regions.push_back(*region);
  }
  return regions;
}

}  // namespace tagsmith::detail
