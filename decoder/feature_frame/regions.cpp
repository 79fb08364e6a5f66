// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/regions.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

namespace tagsmith {
namespace {

constexpr std::uint32_t kNotKept = std::numeric_limits<std::uint32_t>::max();

// Darkest and brightest samples of each tile, and grids of the same shape.
struct TileGrid {
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> low;
  std::vector<std::uint8_t> high;

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
};

// Darkest and brightest sample of each column over the rows of one tile row.
void column_extremes(const GrayView& image, int first_row, int row_count, std::uint8_t* low,
                     std::uint8_t* high) {
  const auto width = static_cast<std::size_t>(image.width);
  std::memcpy(low, image.row(first_row), width);
  std::memcpy(high, image.row(first_row), width);
  for (int y = first_row + 1; y < first_row + row_count; ++y) {
    const std::uint8_t* samples = image.row(y);
    for (std::size_t x = 0; x < width; ++x) {
      low[x] = std::min(low[x], samples[x]);
      high[x] = std::max(high[x], samples[x]);
    }
  }
}

TileGrid tile_extremes(const GrayView& image, int tile) {
  TileGrid grid;
  grid.columns = (image.width + tile - 1) / tile;
  grid.rows = (image.height + tile - 1) / tile;
  const auto count = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
  grid.low.resize(count);
  grid.high.resize(count);
  std::vector<std::uint8_t> low(static_cast<std::size_t>(image.width));
  std::vector<std::uint8_t> high(static_cast<std::size_t>(image.width));
  for (int row = 0; row < grid.rows; ++row) {
    const int first_row = row * tile;
    column_extremes(image, first_row, std::min(tile, image.height - first_row), low.data(),
                    high.data());
    for (int column = 0; column < grid.columns; ++column) {
      const auto first = low.begin() + column * tile;
      const int span = std::min(tile, image.width - column * tile);
      grid.low[grid.index(column, row)] = *std::min_element(first, first + span);
      const auto first_high = high.begin() + column * tile;
      grid.high[grid.index(column, row)] = *std::max_element(first_high, first_high + span);
    }
  }
  return grid;
}

// Per tile, the grey level below which a sample is dark: midway between the extremes of the 3 x 3
// tiles around it, or 0 (nothing is dark) where they are too close.
std::vector<std::uint8_t> tile_thresholds(const TileGrid& grid, int min_contrast) {
  std::vector<std::uint8_t> thresholds(grid.low.size());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      std::uint8_t low = 255;
      std::uint8_t high = 0;
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, grid.rows - 1); ++r) {
        for (int c = std::max(column - 1, 0); c <= std::min(column + 1, grid.columns - 1); ++c) {
          low = std::min(low, grid.low[grid.index(c, r)]);
          high = std::max(high, grid.high[grid.index(c, r)]);
        }
      }
      const int middle = (low + high + 1) / 2;
      thresholds[grid.index(column, row)] =
          static_cast<std::uint8_t>(high - low < min_contrast ? 0 : middle);
    }
  }
  return thresholds;
}

// A maximal stretch of one colour on one row.
struct Run {
  int begin = 0;
  int end = 0;               // exclusive
  std::uint32_t parent = 0;  // index of a run of the same region; a root names itself
  std::uint32_t region = 0;
  bool white = false;
};

std::uint32_t find_root(std::vector<Run>& runs, std::uint32_t index) {
  while (runs[index].parent != index) {
    runs[index].parent = runs[runs[index].parent].parent;
    index = runs[index].parent;
  }
  return index;
}

void join(std::vector<Run>& runs, std::uint32_t a, std::uint32_t b) {
  a = find_root(runs, a);
  b = find_root(runs, b);
  if (a < b) {
    runs[b].parent = a;
  } else {
    runs[a].parent = b;
  }
}

// The first place from `x` on where the row no longer has `colour` (1 white, 0 dark).
int end_of_run(const std::vector<std::uint8_t>& row, int x, std::uint8_t colour) {
  const int width = static_cast<int>(row.size());
  const std::uint64_t alike = colour == 1 ? 0x0101010101010101ULL : 0;
  for (; x + 8 <= width; x += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, row.data() + x, 8);
    if (word == alike) continue;
    if constexpr (std::endian::native == std::endian::little) {
      return x + std::countr_zero(word ^ alike) / 8;
    }
    break;
  }
  while (x < width && row[static_cast<std::size_t>(x)] == colour) ++x;
  return x;
}

void append_runs(const std::vector<std::uint8_t>& row, std::vector<Run>& runs) {
  const int width = static_cast<int>(row.size());
  for (int x = 0; x < width;) {
    const std::uint8_t colour = row[static_cast<std::size_t>(x)];
    const int end = end_of_run(row, x, colour);
    runs.push_back({x, end, static_cast<std::uint32_t>(runs.size()), 0, colour == 1});
    x = end;
  }
}

// All runs, `first_of_row[y]` being the index of row y's first, and joined where runs of one colour
// on neighbouring rows touch.
struct RunMap {
  std::vector<Run> runs;
  std::vector<std::uint32_t> first_of_row;
};

void join_with_row_above(RunMap& map, std::size_t row) {
  std::uint32_t above = map.first_of_row[row - 1];
  const std::uint32_t above_end = map.first_of_row[row];
  for (std::uint32_t here = above_end; here < map.runs.size(); ++here) {
    const int diagonal = map.runs[here].white ? 0 : 1;
    const int begin = map.runs[here].begin - diagonal;
    const int end = map.runs[here].end + diagonal;
    // The row above is covered without gaps: step back to a neighbour that touches diagonally.
    while (above > map.first_of_row[row - 1] && map.runs[above - 1].end > begin) --above;
    while (above < above_end && map.runs[above].end <= begin) ++above;
    for (std::uint32_t other = above; other < above_end && map.runs[other].begin < end; ++other) {
      if (map.runs[other].white == map.runs[here].white) join(map.runs, other, here);
    }
  }
}

RunMap find_runs(const GrayView& image, const RegionOptions& options) {
  const TileGrid grid = tile_extremes(image, options.tile);
  const std::vector<std::uint8_t> thresholds = tile_thresholds(grid, options.min_contrast);
  RunMap map;
  map.runs.reserve(1U << 16U);
  map.first_of_row.reserve(static_cast<std::size_t>(image.height) + 1);
  std::vector<std::uint8_t> threshold_row(static_cast<std::size_t>(image.width));
  std::vector<std::uint8_t> white(static_cast<std::size_t>(image.width));
  for (int y = 0; y < image.height; ++y) {
    if (y % options.tile == 0) {
      for (int x = 0; x < image.width; ++x) {
        threshold_row[static_cast<std::size_t>(x)] =
            thresholds[grid.index(x / options.tile, y / options.tile)];
      }
    }
    const std::uint8_t* samples = image.row(y);
    for (std::size_t x = 0; x < white.size(); ++x) white[x] = samples[x] >= threshold_row[x];
    map.first_of_row.push_back(static_cast<std::uint32_t>(map.runs.size()));
    append_runs(white, map.runs);
    if (y > 0) join_with_row_above(map, static_cast<std::size_t>(y));
  }
  map.first_of_row.push_back(static_cast<std::uint32_t>(map.runs.size()));
  return map;
}

// Gives every run the index of its region in a dense numbering; returns the number of regions. A
// root precedes the runs that point to it.
std::uint32_t number_regions(RunMap& map) {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < map.runs.size(); ++i) {
    Run& run = map.runs[i];
    run.region = run.parent == i ? count++ : map.runs[run.parent].region;
  }
  return count;
}

// Calls `use(row, run)` for every run, row by row.
template <class Use>
void for_each_run(const RunMap& map, const Use& use) {
  for (std::size_t row = 0; row + 1 < map.first_of_row.size(); ++row) {
    for (std::uint32_t i = map.first_of_row[row]; i < map.first_of_row[row + 1]; ++i) {
      use(static_cast<int>(row), map.runs[i]);
    }
  }
}

// Bounding box and area of every region.
std::vector<Region> measure_regions(RunMap& map) {
  std::vector<Region> regions(number_regions(map));
  for_each_run(map, [&](int y, const Run& run) {
    Region& region = regions[run.region];
    if (region.area == 0) region = {run.white, run.begin, y, run.end - 1, y, 0, {}};
    region.left = std::min(region.left, run.begin);
    region.right = std::max(region.right, run.end - 1);
    region.bottom = y;
    region.area += run.end - run.begin;
  });
  return regions;
}

// Leftmost and rightmost pixels of the regions that `kept_index` numbers, row by row.
void add_outlines(const RunMap& map, const std::vector<std::uint32_t>& kept_index,
                  std::vector<Region>& kept) {
  for_each_run(map, [&](int y, const Run& run) {
    const std::uint32_t index = kept_index[run.region];
    if (index == kNotKept) return;
    std::vector<PixelPoint>& outline = kept[index].outline;
    const PixelPoint end{static_cast<double>(run.end - 1), static_cast<double>(y)};
    if (!outline.empty() && outline.back().y == end.y) {
      outline.back() = end;
      return;
    }
    outline.push_back({static_cast<double>(run.begin), static_cast<double>(y)});
    outline.push_back(end);
  });
}

}  // namespace

std::vector<Region> find_regions(const GrayView& image, const RegionOptions& options) {
  if (image.width < options.min_width || image.height < options.min_height) return {};
  RunMap map = find_runs(image, options);
  std::vector<Region> measured = measure_regions(map);
  std::vector<Region> kept;
  std::vector<std::uint32_t> kept_index(measured.size(), kNotKept);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    Region& region = measured[i];
    if (region.right - region.left + 1 < options.min_width ||
        region.bottom - region.top + 1 < options.min_height) {
      continue;
    }
    kept_index[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(std::move(region));
  }
  add_outlines(map, kept_index, kept);
  return kept;
}

}  // namespace tagsmith
