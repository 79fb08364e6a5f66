// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/bar_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <utility>

#include "decoder/feature_frame/bar_direction.hpp"

namespace tagsmith {
namespace {

constexpr int kTileSize = 8;

// Sums of products of the gradient over a tile (Bigun and Granlund 1987, "Optimal orientation
// detection of linear symmetry"): x x - y y and 2 x y give the direction, x x + y y the strength.
struct Tensor {
  std::int32_t difference = 0;
  std::int32_t twice_product = 0;
  std::int32_t strength = 0;

  double agreement() const {
    return std::hypot(difference, twice_product) / std::max(1.0, static_cast<double>(strength));
  }
};

struct TensorGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Tensor> tiles;

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
};

// Adds the gradients of eight pixels of a row.
void add_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
             Tensor& tensor) {
  std::int32_t xx = 0;
  std::int32_t yy = 0;
  std::int32_t xy = 0;
  for (int x = 0; x < kTileSize; ++x) {
    const auto dx = static_cast<std::int16_t>(here[x + 1] - here[x - 1]);
    const auto dy = static_cast<std::int16_t>(below[x] - above[x]);
    xx += dx * dx;
    yy += dy * dy;
    xy += dx * dy;
  }
  tensor.difference += xx - yy;
  tensor.twice_product += 2 * xy;
  tensor.strength += xx + yy;
}

// Every other row is enough: bars are longer than that.
TensorGrid tensors_of(const GrayView& image) {
  TensorGrid grid{image.width / kTileSize, image.height / kTileSize, {}};
  grid.tiles.resize(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows));
  for (int y = 2; y + 2 < grid.rows * kTileSize; y += 2) {
    for (int column = 1; column + 1 < grid.columns; ++column) {
      const int x = column * kTileSize;
      add_row(image.row(y - 1) + x, image.row(y) + x, image.row(y + 1) + x,
              grid.tiles[grid.index(column, y / kTileSize)]);
    }
  }
  return grid;
}

// Bars make a tile's gradients strong and of one direction.
bool is_barred(const Tensor& tensor) {
  constexpr int kLeastStrength = 32 * 6 * 6;  // 6 grey levels between a pixel's neighbours
  constexpr double kLeastAgreement = 0.35;    // isotropic noise of twice the strength of the bars
  return tensor.strength > kLeastStrength && tensor.agreement() > kLeastAgreement;
}

bool same_direction(const Tensor& a, const Tensor& b) {
  constexpr double kCosine = 0.7;  // of twice the angle: 23 degrees
  const double product = static_cast<double>(a.difference) * b.difference +
                         static_cast<double>(a.twice_product) * b.twice_product;
  return product > kCosine * std::hypot(a.difference, a.twice_product) *
                       std::hypot(b.difference, b.twice_product);
}

bool contains(const Quad& quad, PixelPoint point) {
  for (std::size_t i = 0; i < 4; ++i) {
    if (cross(quad[(i + 1) % 4] - quad[i], point - quad[i]) < 0) return false;
  }
  return true;
}

struct Cluster {
  std::vector<PixelPoint> centres;  // of its tiles
  PixelPoint direction;             // twice the angle of the gradient, weighted by strength
};

// Collects the tiles that hang together with this one, diagonal neighbours included.
Cluster grow(const TensorGrid& grid, std::vector<bool>& open, std::size_t start) {
  Cluster cluster;
  std::vector<std::size_t> queue{start};
  open[start] = false;
  while (!queue.empty()) {
    const std::size_t at = queue.back();
    queue.pop_back();
    const int column = static_cast<int>(at % static_cast<std::size_t>(grid.columns));
    const int row = static_cast<int>(at / static_cast<std::size_t>(grid.columns));
    const Tensor& tensor = grid.tiles[at];
    cluster.centres.push_back({kTileSize * (column + 0.5) - 0.5, kTileSize * (row + 0.5) - 0.5});
    cluster.direction = cluster.direction + PixelPoint{static_cast<double>(tensor.difference),
                                                       static_cast<double>(tensor.twice_product)};
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, grid.rows - 1); ++r) {
      for (int c = std::max(column - 1, 0); c <= std::min(column + 1, grid.columns - 1); ++c) {
        const std::size_t next = grid.index(c, r);
        if (!open[next] || !same_direction(tensor, grid.tiles[next])) continue;
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
  block.half_width = (right - left + kTileSize) / 2;
  block.half_height = (bottom - top + kTileSize) / 2;
  if (block.half_width < 2 * kTileSize || block.half_height < kTileSize) return std::nullopt;
  const double tiles = 4 * block.half_width * block.half_height / (kTileSize * kTileSize);
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

std::vector<BarBlock> find_bar_blocks(const GrayView& image, std::span<const Quad> known) {
  constexpr std::size_t kMaxClusters = 12;
  constexpr std::size_t kLeastTiles = 4;
  const TensorGrid grid = tensors_of(image);
  std::vector<bool> open(grid.tiles.size());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const PixelPoint centre{kTileSize * (column + 0.5), kTileSize * (row + 0.5)};
      const auto holds = [&](const Quad& quad) { return contains(quad, centre); };
      const std::size_t index = grid.index(column, row);
      open[index] = is_barred(grid.tiles[index]) && std::ranges::none_of(known, holds);
    }
  }
  std::vector<Cluster> clusters;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (!open[i]) continue;
    Cluster cluster = grow(grid, open, i);
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
