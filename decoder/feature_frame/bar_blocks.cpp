// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/bar_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "decoder/feature_frame/bar_direction.hpp"

namespace tagsmith {
namespace {

// The tiles of bars, and the directions of their gradients.
struct BarredTiles {
  int columns = 0;
  int rows = 0;
  std::vector<Gradient> gradients;
  std::vector<std::uint8_t> open;  // tiles of bars that belong to no cluster yet
  std::vector<std::size_t> queue;  // those whose neighbours are to be looked at
};

bool same_direction(const Gradient& a, const Gradient& b) {
  constexpr float kCosine = 0.7F;  // of twice the angle: 23 degrees
  const auto square = [](const Gradient& gradient) {
    const auto x = static_cast<float>(gradient.cos2), y = static_cast<float>(gradient.sin2);
    return x * x + y * y;
  };
  const float product = static_cast<float>(a.cos2) * static_cast<float>(b.cos2) +
                        static_cast<float>(a.sin2) * static_cast<float>(b.sin2);
  return product > 0 && product * product > kCosine * kCosine * square(a) * square(b);
}

BarredTiles barred_tiles(const TextureGrid& grid, std::span<const Quad> known) {
  constexpr int kLeastStrength = 120;  // 4 grey levels from pixel to pixel
  BarredTiles barred{grid.columns,
                     grid.rows,
                     std::vector<Gradient>(grid.tiles.size()),
                     std::vector<std::uint8_t>(grid.tiles.size()),
                     {}};
  for (std::size_t i = 0; i < grid.tiles.size(); ++i) {
    barred.gradients[i] = gradient_of(grid.tiles[i]);
    barred.open[i] = is_directed(barred.gradients[i], kLeastStrength) ? 1 : 0;
  }
  for (int row = 0; row < grid.rows; ++row) {
    const auto first = barred.open.begin() + static_cast<std::ptrdiff_t>(row) * grid.columns;
    for (const Quad& quad : known) {
      const auto [begin, end] = tiles_in_row(quad, row, grid.columns);
      std::fill(first + begin, first + end, std::uint8_t{0});
    }
  }
  return barred;
}

struct Cluster {
  std::vector<PixelPoint> centres;  // of its tiles
  PixelPoint direction;             // twice the angle of the gradient, weighted by strength
};

// Collects the tiles that hang together with this one, diagonal neighbours included.
Cluster grow(BarredTiles& tiles, std::size_t start) {
  const auto columns = static_cast<std::size_t>(tiles.columns);
  Cluster cluster;
  tiles.queue.push_back(start);
  tiles.open[start] = 0;
  while (!tiles.queue.empty()) {
    const std::size_t at = tiles.queue.back();
    tiles.queue.pop_back();
    const int column = static_cast<int>(at % columns);
    const int row = static_cast<int>(at / columns);
    const Gradient& gradient = tiles.gradients[at];
    cluster.centres.push_back({kTile * (column + 0.5) - 0.5, kTile * (row + 0.5) - 0.5});
    cluster.direction = cluster.direction + PixelPoint{static_cast<double>(gradient.cos2),
                                                       static_cast<double>(gradient.sin2)};
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, tiles.rows - 1); ++r) {
      for (int c = std::max(column - 1, 0); c <= std::min(column + 1, tiles.columns - 1); ++c) {
        const std::size_t next =
            static_cast<std::size_t>(r) * columns + static_cast<std::size_t>(c);
        if (tiles.open[next] == 0 || !same_direction(gradient, tiles.gradients[next])) continue;
        tiles.open[next] = 0;
        tiles.queue.push_back(next);
      }
    }
  }
  return cluster;
}

// The value that comes before all but `before` others, in the order of `less`; rearranges them.
template <class Less>
double value_after(std::vector<double>& values, std::size_t before, const Less& less) {
  constexpr std::size_t kFew = 6;
  if (before >= kFew) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(before);
    std::ranges::nth_element(values, place, less);
    return *place;
  }
  // The first ones in order: few values come among them.
  std::array<double, kFew> first{};
  std::size_t count = 0;
  for (const double value : values) {
    if (count > before && !less(value, first[before])) continue;
    std::size_t at = std::min(count, before);
    for (; at > 0 && less(value, first[at - 1]); --at) first[at] = first[at - 1];
    first[at] = value;
    count = std::min(count + 1, before + 1);
  }
  return first[before];
}

// The extent of the values without this share of the least and of the greatest.
struct Extent {
  double low = 0;
  double high = 0;
};

Extent extent_of(std::vector<double>& values, double share) {
  const std::size_t last = values.size() - 1;
  const auto low = static_cast<std::size_t>(share * static_cast<double>(last));
  const auto high = static_cast<std::size_t>((1 - share) * static_cast<double>(last));
  return {value_after(values, low, std::less{}), value_after(values, last - high, std::greater{})};
}

// The rectangle around a cluster without its stragglers; nothing when it is too small or too thin
// for a symbol, or the rectangle is mostly empty.
std::optional<BarBlock> block_of(const Cluster& cluster) {
  constexpr std::size_t kLeastTiles = 8;
  constexpr double kStragglers = 0.03;
  constexpr double kLeastFill = 0.5;
  if (cluster.centres.size() < kLeastTiles) return std::nullopt;
  const double angle = std::atan2(cluster.direction.y, cluster.direction.x) / 2;
  BarBlock block;
  block.across = {std::cos(angle), std::sin(angle)};
  block.along = {-block.across.y, block.across.x};
  std::vector<double> across(cluster.centres.size());
  std::vector<double> along(cluster.centres.size());
  for (std::size_t i = 0; i < cluster.centres.size(); ++i) {
    across[i] = dot(cluster.centres[i], block.across);
    along[i] = dot(cluster.centres[i], block.along);
  }
  const auto [left, right] = extent_of(across, kStragglers);
  const auto [top, bottom] = extent_of(along, kStragglers);
  block.centre = (left + right) / 2 * block.across + (top + bottom) / 2 * block.along;
  block.half_width = (right - left + kTile) / 2;
  block.half_height = (bottom - top + kTile) / 2;
  if (block.half_width < 2 * kTile || block.half_height < kTile) return std::nullopt;
  const double tiles = 4 * block.half_width * block.half_height / (kTile * kTile);
  if (static_cast<double>(cluster.centres.size()) < kLeastFill * tiles) return std::nullopt;
  return block;
}

// Two clusters as one when together they still fill a rectangle.
std::optional<BarBlock> block_of(const Cluster& a, const Cluster& b) {
  constexpr double kCosine = 0.94;  // of twice the angle: 10 degrees
  if (dot(a.direction, b.direction) < kCosine * length(a.direction) * length(b.direction)) {
    return std::nullopt;
  }
  Cluster both = a;
  both.centres.insert(both.centres.end(), b.centres.begin(), b.centres.end());
  both.direction = a.direction + b.direction;
  return block_of(both);
}

}  // namespace

BarBlock scaled(const BarBlock& block, double scale) {
  const double offset = (scale - 1) / 2;
  return {scale * block.centre + PixelPoint{offset, offset}, block.across, block.along,
          scale * block.half_width, scale * block.half_height};
}

bool runs_off(const GrayView& image, const BarBlock& block) {
  constexpr double kMargin = kTile + 2;
  const auto is_at_border = [&](PixelPoint at) {
    return at.x < kMargin || at.y < kMargin || at.x > image.width - 1 - kMargin ||
           at.y > image.height - 1 - kMargin;
  };
  const PixelPoint reach = block.half_width * block.across;
  return is_at_border(block.centre - reach) || is_at_border(block.centre + reach);
}

bool is_symbol_like(const GrayView& image, const BarBlock& block) {
  constexpr double kMiddle = 0.6;   // of the block: bars, not the frame's sides
  constexpr double kLeastStep = 2;  // grey levels
  constexpr double kLeastRatio = 2;
  const PixelPoint right = kMiddle * block.half_width * block.across;
  const PixelPoint down = kMiddle * block.half_height * block.along;
  const PixelPoint& c = block.centre;
  const BarSteps steps =
      bar_steps(image, {c - right - down, c + right - down, c + right + down, c - right + down});
  return steps.along > kLeastStep && steps.along > kLeastRatio * steps.across;
}

std::vector<BarBlock> find_bar_blocks(const TextureGrid& texture, std::span<const Quad> known) {
  constexpr std::size_t kMaxClusters = 12;
  constexpr std::size_t kLeastTiles = 4;
  BarredTiles tiles = barred_tiles(texture, known);
  std::vector<Cluster> clusters;
  for (std::size_t i = 0; i < tiles.open.size(); ++i) {
    if (tiles.open[i] == 0) continue;
    Cluster cluster = grow(tiles, i);
    if (cluster.centres.size() >= kLeastTiles) clusters.push_back(std::move(cluster));
  }
  std::ranges::sort(clusters, [](const Cluster& a, const Cluster& b) {
    return a.centres.size() > b.centres.size();
  });
  clusters.resize(std::min(clusters.size(), kMaxClusters));
  std::vector<BarBlock> blocks;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    if (const auto block = block_of(clusters[i])) blocks.push_back(*block);
    for (std::size_t j = i + 1; j < clusters.size(); ++j) {
      if (const auto block = block_of(clusters[i], clusters[j])) blocks.push_back(*block);
    }
  }
  return blocks;
}

}  // namespace tagsmith
