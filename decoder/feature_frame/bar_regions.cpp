// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/bar_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "decoder/feature_frame/tuning.hpp"

namespace tagsmith::detail {
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

// Collects the tiles that hang together with this one, diagonal neighbours included.
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
