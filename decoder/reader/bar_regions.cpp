// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/bar_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "decoder/image/half_size.hpp"

namespace tagsmith {
namespace {

constexpr int kCell = 8;  // pixels
constexpr double kMaxPixels = 2e6;
constexpr std::size_t kLevels = 4;
constexpr int kLeastSide = 24;  // pixels of a level worth looking at

// The structure tensor of a cell: energy, and the doubled-angle vector of its main direction.
struct Texture {
  float energy = 0;  // squared gradient, summed
  float cos2 = 0;    // Jxx - Jyy
  float sin2 = 0;    // 2 Jxy

  float squared_strength() const { return cos2 * cos2 + sin2 * sin2; }
  bool is_coherent(float share) const {
    return squared_strength() > share * share * energy * energy;
  }
};

struct TextureGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Texture> cells;

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
};

using Gradients = std::array<std::int16_t, kCell * kCell / 2>;

int product(const Gradients& a, const Gradients& b) {
  int sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Gradients of every second row suffice for sums over cells.
Texture texture_of_cell(const GrayView& image, int x, int y) {
  Gradients gx, gy;
  for (std::size_t row = 0; row < kCell / 2; ++row) {
    const std::uint8_t* here = image.row(y + 2 * static_cast<int>(row)) + x;
    const std::uint8_t* above = here - image.stride;
    const std::uint8_t* below = here + image.stride;
    for (std::size_t i = 0; i < kCell; ++i) {
      gx[row * kCell + i] = static_cast<std::int16_t>(here[i + 1] - (here - 1)[i]);
      gy[row * kCell + i] = static_cast<std::int16_t>(below[i] - above[i]);
    }
  }
  const int xx = product(gx, gx), yy = product(gy, gy), xy = product(gx, gy);
  return {static_cast<float>(xx + yy), static_cast<float>(xx - yy), static_cast<float>(2 * xy)};
}

// Cells begin one pixel inside the image, so that every gradient has its neighbours.
TextureGrid texture_of(const GrayView& image) {
  TextureGrid grid{(image.width - 2) / kCell, (image.height - 2) / kCell, {}};
  grid.cells.reserve(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows));
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      grid.cells.push_back(texture_of_cell(image, 1 + column * kCell, 1 + row * kCell));
    }
  }
  return grid;
}

Texture operator+(const Texture& a, const Texture& b) {
  return {a.energy + b.energy, a.cos2 + b.cos2, a.sin2 + b.sin2};
}

// Each cell with its neighbours.
TextureGrid smoothed(const TextureGrid& grid) {
  TextureGrid across = grid;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      Texture& sum = across.cells[grid.index(column, row)];
      if (column > 0) sum = sum + grid.cells[grid.index(column - 1, row)];
      if (column + 1 < grid.columns) sum = sum + grid.cells[grid.index(column + 1, row)];
    }
  }
  TextureGrid sums = across;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      Texture& sum = sums.cells[grid.index(column, row)];
      if (row > 0) sum = sum + across.cells[grid.index(column, row - 1)];
      if (row + 1 < grid.rows) sum = sum + across.cells[grid.index(column, row + 1)];
    }
  }
  return sums;
}

bool is_striped(const Texture& texture) {
  constexpr float kCoherence = 0.5F;
  // Over nine cells with 32 gradients each: 4 grey levels of difference over two pixels.
  constexpr float kLeastEnergy = 9 * 32 * 16.0F;
  return texture.energy > kLeastEnergy && texture.is_coherent(kCoherence);
}

// One cell alone: noise makes it less sure of its direction.
bool is_striped_cell(const Texture& texture) {
  constexpr float kCoherence = 0.4F;
  constexpr float kLeastEnergy = 32 * 36.0F;
  return texture.energy > kLeastEnergy && texture.is_coherent(kCoherence);
}

bool same_direction(const Texture& a, const Texture& b) {
  constexpr float kCosine = 0.82F;  // of the doubled angle: 17 degrees
  const float product = a.cos2 * b.cos2 + a.sin2 * b.sin2;
  return product > 0 &&
         product * product > kCosine * kCosine * a.squared_strength() * b.squared_strength();
}

using CellList = std::vector<std::pair<int, int>>;

// Takes the striped cells that hang together with `seed`, neighbour by neighbour.
CellList grow(const TextureGrid& grid, std::vector<std::uint8_t>& open, std::pair<int, int> seed) {
  CellList cells{seed};
  open[grid.index(seed.first, seed.second)] = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto [column, row] = cells[i];
    const Texture& here = grid.cells[grid.index(column, row)];
    for (int y = std::max(0, row - 1); y <= std::min(grid.rows - 1, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(grid.columns - 1, column + 1); ++x) {
        const std::size_t next = grid.index(x, y);
        if (open[next] == 0 || !same_direction(here, grid.cells[next])) continue;
        open[next] = 0;
        cells.emplace_back(x, y);
      }
    }
  }
  return cells;
}

PixelPoint pixel_of(const std::pair<int, int>& cell) {
  return {1 + (cell.first + 0.5) * kCell - 0.5, 1 + (cell.second + 0.5) * kCell - 0.5};
}

struct Range {
  double low = std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::lowest();

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

BarRegion region_of(const TextureGrid& grid, const CellList& cells) {
  double cos2 = 0;
  double sin2 = 0;
  for (const auto& [column, row] : cells) {
    const Texture& texture = grid.cells[grid.index(column, row)];
    cos2 += texture.cos2;
    sin2 += texture.sin2;
  }
  const double angle = std::atan2(sin2, cos2) / 2;
  BarRegion region;
  region.across = {std::cos(angle), std::sin(angle)};
  const PixelPoint along{-region.across.y, region.across.x};
  Range across_range;
  Range along_range;
  for (const auto& cell : cells) {
    across_range.add(dot(pixel_of(cell), region.across));
    along_range.add(dot(pixel_of(cell), along));
  }
  region.length = across_range.high - across_range.low + kCell;
  region.height = along_range.high - along_range.low + kCell;
  region.centre = (across_range.low + across_range.high) / 2 * region.across +
                  (along_range.low + along_range.high) / 2 * along;
  return region;
}

constexpr double kLeastLength = 40;  // 95 modules of half a pixel, less the smoothing's loss
constexpr double kLeastFilled = 0.35;
constexpr std::size_t kLeastCells = 2;  // of that length, one cell high

bool may_be_symbol(const BarRegion& region, std::size_t cells) {
  const double area = region.length * region.height / (kCell * kCell);
  return region.length >= kLeastLength && region.length > 0.5 * region.height &&
         static_cast<double>(cells) > kLeastFilled * area;
}

// The cells whose neighbours above, below and beside them are taken too: what hangs together by
// the edge of a plate or of a cable comes apart.
std::vector<std::uint8_t> cores_of(const TextureGrid& grid,
                                   const std::vector<std::uint8_t>& striped) {
  std::vector<std::uint8_t> cores(striped.size());
  for (int row = 1; row + 1 < grid.rows; ++row) {
    for (int column = 1; column + 1 < grid.columns; ++column) {
      cores[grid.index(column, row)] =
          striped[grid.index(column, row)] & striped[grid.index(column - 1, row)] &
          striped[grid.index(column + 1, row)] & striped[grid.index(column, row - 1)] &
          striped[grid.index(column, row + 1)];
    }
  }
  return cores;
}

void add_regions(const TextureGrid& texture, double scale, bool apart,
                 std::vector<BarRegion>& regions) {
  const TextureGrid grid = apart ? texture : smoothed(texture);
  std::vector<std::uint8_t> open(grid.cells.size());
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i] = (apart ? is_striped_cell(grid.cells[i]) : is_striped(grid.cells[i])) ? 1 : 0;
  }
  if (apart) open = cores_of(grid, open);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (open[grid.index(column, row)] == 0) continue;
      const CellList cells = grow(grid, open, {column, row});
      if (cells.size() < kLeastCells) continue;
      BarRegion region = region_of(grid, cells);
      if (!may_be_symbol(region, cells.size())) continue;
      const double shift = (scale - 1) / 2;  // pixel centres of a reduced image
      region.centre = scale * region.centre + PixelPoint{shift, shift};
      region.length *= scale;
      region.height *= scale;
      regions.push_back(region);
    }
  }
}

bool same_region(const BarRegion& a, const BarRegion& b) {
  return distance(a.centre, b.centre) < 0.15 * a.length &&
         std::abs(dot(a.across, b.across)) > 0.97 && a.length < 1.25 * b.length &&
         b.length < 1.25 * a.length;
}

// A level of the image's reductions as cells.
struct CellLevel {
  TextureGrid texture;
  double scale = 1;
};

std::vector<CellLevel> cell_levels(const GrayView& image) {
  std::vector<CellLevel> levels;
  GrayImage reduced;
  GrayView level = image;
  double scale = 1;
  while (levels.size() < kLevels && std::min(level.width, level.height) >= kLeastSide) {
    if (static_cast<double>(level.width) * level.height <= kMaxPixels) {
      levels.push_back({texture_of(level), scale});
    }
    reduced = half_size(level);
    level = reduced.view();
    scale *= 2;
  }
  return levels;
}

// All regions of the levels, largest first.
std::vector<BarRegion> regions_of(const std::vector<CellLevel>& levels, bool apart) {
  std::vector<BarRegion> regions;
  for (const CellLevel& level : levels) add_regions(level.texture, level.scale, apart, regions);
  const auto area = [](const BarRegion& region) { return region.length * region.height; };
  std::ranges::stable_sort(regions, std::ranges::greater{}, area);
  return regions;
}

}  // namespace

struct BarRegions::Cells {
  std::vector<CellLevel> levels;
  std::array<std::optional<std::vector<BarRegion>>, 2> regions;  // whole, apart
};

BarRegions::BarRegions(const GrayView& image) : image_(image) {}
BarRegions::BarRegions(BarRegions&&) noexcept = default;
BarRegions& BarRegions::operator=(BarRegions&&) noexcept = default;
BarRegions::~BarRegions() = default;

std::vector<BarRegion> BarRegions::whole(std::size_t most) { return first_of(false, most); }

std::vector<BarRegion> BarRegions::apart(std::size_t most) { return first_of(true, most); }

std::vector<BarRegion> BarRegions::first_of(bool apart, std::size_t most) {
  if (!cells_) cells_ = std::make_unique<Cells>(Cells{cell_levels(image_), {}});
  std::optional<std::vector<BarRegion>>& found = cells_->regions[apart ? 1 : 0];
  if (!found) found = regions_of(cells_->levels, apart);
  std::vector<BarRegion> regions;
  for (const BarRegion& region : *found) {
    if (regions.size() == most) break;
    const auto same = [&](const BarRegion& other) { return same_region(region, other); };
    if (std::ranges::none_of(regions, same)) regions.push_back(region);
  }
  return regions;
}

}  // namespace tagsmith
