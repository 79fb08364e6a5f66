// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/bar_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "decoder/feature_frame/bar_direction.hpp"

namespace tagsmith {
namespace {

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

// Tiles of bars that belong to no cluster yet, by their index in the grid.
std::vector<bool> barred_tiles(const TextureGrid& grid, std::span<const Quad> known) {
  constexpr int kLeastStrength = 120;  // 4 grey levels from pixel to pixel
  std::vector<bool> open(grid.tiles.size());
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i] = is_directed(gradient_of(grid.tiles[i]), kLeastStrength);
  }
  for (int row = 0; row < grid.rows; ++row) {
    const auto first = static_cast<std::ptrdiff_t>(row) * grid.columns;
    for (const Quad& quad : known) {
      const auto [begin, end] = tiles_in_row(quad, row, grid.columns);
      std::fill(open.begin() + first + begin, open.begin() + first + end, false);
    }
  }
  return open;
}

struct Cluster {
  std::vector<PixelPoint> centres;  // of its tiles
  PixelPoint direction;             // twice the angle of the gradient, weighted by strength
};

// Collects the tiles that hang together with this one, diagonal neighbours included.
Cluster grow(const TextureGrid& grid, std::vector<bool>& open, std::size_t start) {
  const auto columns = static_cast<std::size_t>(grid.columns);
  Cluster cluster;
  std::vector<std::size_t> queue{start};
  open[start] = false;
  while (!queue.empty()) {
    const std::size_t at = queue.back();
    queue.pop_back();
    const int column = static_cast<int>(at % columns);
    const int row = static_cast<int>(at / columns);
    const Gradient gradient = gradient_of(grid.tiles[at]);
    cluster.centres.push_back({kTile * (column + 0.5) - 0.5, kTile * (row + 0.5) - 0.5});
    cluster.direction = cluster.direction + PixelPoint{static_cast<double>(gradient.cos2),
                                                       static_cast<double>(gradient.sin2)};
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, grid.rows - 1); ++r) {
      for (int c = std::max(column - 1, 0); c <= std::min(column + 1, grid.columns - 1); ++c) {
        const std::size_t next =
            static_cast<std::size_t>(r) * columns + static_cast<std::size_t>(c);
        if (!open[next] || !same_direction(gradient, gradient_of(grid.tiles[next]))) continue;
        open[next] = false;
        queue.push_back(next);
      }
    }
  }
  return cluster;
}

// The value that this share of the values does not exceed.
double quantile(std::vector<double>& values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
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
  std::vector<double> across;
  std::vector<double> along;
  for (const PixelPoint& centre : cluster.centres) {
    across.push_back(dot(centre, block.across));
    along.push_back(dot(centre, block.along));
  }
  const double left = quantile(across, kStragglers), right = quantile(across, 1 - kStragglers);
  const double top = quantile(along, kStragglers), bottom = quantile(along, 1 - kStragglers);
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
  std::vector<bool> open = barred_tiles(texture, known);
  std::vector<Cluster> clusters;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (!open[i]) continue;
    Cluster cluster = grow(texture, open, i);
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
