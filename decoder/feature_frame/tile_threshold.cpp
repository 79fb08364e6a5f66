// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/tile_threshold.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace tagsmith::detail {
namespace {

using Samples = std::vector<std::uint8_t>;

struct Least {
  std::uint8_t operator()(std::uint8_t a, std::uint8_t b) const { return a < b ? a : b; }
};

struct Greatest {
  std::uint8_t operator()(std::uint8_t a, std::uint8_t b) const { return a > b ? a : b; }
};

// Two tiles' columns side by side, in the compiler's own vectors (GCC manual, "Vector Extensions"),
// which exist for every machine.
constexpr std::size_t kLanes = 16;
using Bytes = std::uint8_t __attribute__((vector_size(kLanes)));
using Halves = std::uint64_t __attribute__((vector_size(kLanes)));

Bytes least_of(Bytes a, Bytes b) { return a < b ? a : b; }
Bytes greatest_of(Bytes a, Bytes b) { return a > b ? a : b; }

// The eight bytes of each half combined into one, in the half's lowest byte.
template <class Fold>
Halves fold_halves(Bytes values, const Fold& fold) {
  for (const int shift : {32, 16, 8}) {
    values = fold(values, reinterpret_cast<Bytes>(reinterpret_cast<Halves>(values) >> shift));
  }
  return reinterpret_cast<Halves>(values);
}

using TileRows = std::array<const std::uint8_t*, kTile>;

// Extremes of the two tiles whose rows begin `x` samples from `rows`.
void two_tile_extremes(const TileRows& rows, std::size_t x, std::uint8_t* low, std::uint8_t* high) {
  Bytes least;
  std::memcpy(&least, rows[0] + x, kLanes);
  Bytes greatest = least;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    Bytes samples;
    std::memcpy(&samples, rows[i] + x, kLanes);
    least = least_of(least, samples);
    greatest = greatest_of(greatest, samples);
  }
  const Halves lows = fold_halves(least, least_of);
  const Halves highs = fold_halves(greatest, greatest_of);
  low[0] = static_cast<std::uint8_t>(lows[0]);
  low[1] = static_cast<std::uint8_t>(lows[1]);
  high[0] = static_cast<std::uint8_t>(highs[0]);
  high[1] = static_cast<std::uint8_t>(highs[1]);
}

// Extremes of one tile of `width` columns.
void cut_tile_extremes(const TileRows& rows, std::size_t x, std::size_t width, std::uint8_t* low,
                       std::uint8_t* high) {
  *low = 255;
  *high = 0;
  for (const std::uint8_t* row : rows) {
    const auto [least, greatest] = std::minmax_element(row + x, row + x + width);
    *low = std::min(*low, *least);
    *high = std::max(*high, *greatest);
  }
}

// For every cell of a grid the best of the 3 x 3 around it.
template <class Better>
Samples best_around(const Samples& grid, int columns, int rows) {
  constexpr Better kBetter;
  const auto width = static_cast<std::size_t>(columns);
  Samples across(grid.size());
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) {
    const std::uint8_t* from = grid.data() + row * width;
    std::uint8_t* __restrict to = across.data() + row * width;
    to[0] = kBetter(from[0], from[width > 1 ? 1 : 0]);
    for (std::size_t x = 1; x + 1 < width; ++x) {
      to[x] = kBetter(kBetter(from[x - 1], from[x]), from[x + 1]);
    }
    to[width - 1] = kBetter(from[width - 1], from[width > 1 ? width - 2 : 0]);
  }
  Samples around(grid.size());
  for (int row = 0; row < rows; ++row) {
    const std::uint8_t* here = across.data() + static_cast<std::size_t>(row) * width;
    const std::uint8_t* above = row > 0 ? here - width : here;
    const std::uint8_t* below = row + 1 < rows ? here + width : here;
    std::uint8_t* __restrict to = around.data() + static_cast<std::size_t>(row) * width;
    for (std::size_t x = 0; x < width; ++x) to[x] = kBetter(kBetter(above[x], here[x]), below[x]);
  }
  return around;
}

// One by one, for the end of a row and for machines without SSE2.
std::uint64_t dark_bits(const std::uint8_t* samples, const std::uint8_t* thresholds, int count) {
  std::uint64_t bits = 0;
  for (int i = 0; i < count; ++i) {
    bits |= static_cast<std::uint64_t>(samples[i] < thresholds[i / kTile] ? 1 : 0) << i;
  }
  return bits;
}

#if defined(__SSE2__)
using Pairs = std::uint16_t __attribute__((vector_size(kLanes)));
using Quads = std::uint32_t __attribute__((vector_size(kLanes)));

// Bits of 16 pixels: their sign bits gathered, for which compilers have no portable operation.
std::uint64_t dark_bits16(const std::uint8_t* samples, Quads thresholds) {
  using Chars = char __attribute__((vector_size(kLanes)));
  Bytes values;
  std::memcpy(&values, samples, kLanes);
  const Bytes least = least_of(values, reinterpret_cast<Bytes>(thresholds));
  const auto white = reinterpret_cast<Chars>(least == reinterpret_cast<Bytes>(thresholds));
  return ~static_cast<unsigned>(__builtin_ia32_pmovmskb128(white)) & 0xFFFFU;
}

// 64 pixels of a row, of eight tiles, whose thresholds are first repeated eight times each.
std::uint64_t dark_word(const std::uint8_t* samples, const std::uint8_t* thresholds) {
  Halves eight{};
  std::uint64_t word = 0;
  std::memcpy(&word, thresholds, sizeof word);
  eight[0] = word;
  const auto tiles = reinterpret_cast<Bytes>(eight);
  const auto twice = reinterpret_cast<Pairs>(__builtin_shufflevector(
      tiles, tiles, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23));
  const auto low =
      reinterpret_cast<Quads>(__builtin_shufflevector(twice, twice, 0, 8, 1, 9, 2, 10, 3, 11));
  const auto high =
      reinterpret_cast<Quads>(__builtin_shufflevector(twice, twice, 4, 12, 5, 13, 6, 14, 7, 15));
  return dark_bits16(samples, __builtin_shufflevector(low, low, 0, 4, 1, 5)) |
         dark_bits16(samples + 16, __builtin_shufflevector(low, low, 2, 6, 3, 7)) << 16U |
         dark_bits16(samples + 32, __builtin_shufflevector(high, high, 0, 4, 1, 5)) << 32U |
         dark_bits16(samples + 48, __builtin_shufflevector(high, high, 2, 6, 3, 7)) << 48U;
}
#else
std::uint64_t dark_word(const std::uint8_t* samples, const std::uint8_t* thresholds) {
  return dark_bits(samples, thresholds, 64);
}
#endif

// The number of ones in each byte.
std::uint64_t ones_of_bytes(std::uint64_t bits) {
  bits -= bits >> 1U & 0x5555555555555555U;
  bits = (bits & 0x3333333333333333U) + (bits >> 2U & 0x3333333333333333U);
  return (bits + (bits >> 4U)) & 0x0F0F0F0F0F0F0F0FU;
}

// Whether one of the tiles of a word of a row, or of its last word, is not flat.
bool is_used(const std::uint8_t* thresholds, std::size_t columns, std::size_t word) {
  std::uint64_t any = 0;
  const std::size_t first = word * kTile;
  if (first + kTile <= columns) {
    std::memcpy(&any, thresholds + first, kTile);
  } else {
    std::memcpy(&any, thresholds + first, columns - first);
  }
  return any != 0;
}

// The first and the last word of a row of tiles with a threshold that is not flat: begin and end.
std::array<std::size_t, 2> used_words(const std::uint8_t* thresholds, std::size_t columns) {
  std::size_t begin = 0, end = (columns + kTile - 1) / kTile;
  while (begin < end && !is_used(thresholds, columns, begin)) ++begin;
  while (begin < end && !is_used(thresholds, columns, end - 1)) --end;
  return begin < end ? std::array{begin, end} : std::array<std::size_t, 2>{};
}

// Marks a row of tiles and counts the changes of colour in each of them.
class TileRowMarker {
 public:
  TileRowMarker(const GrayView& image, int row, DarkPixels& dark)
      : image_(image), y_(row * kTile), rows_(std::min(kTile, image.height - y_)), dark_(dark) {}

  void mark(std::size_t word, const std::uint8_t* thresholds, std::uint8_t* changes, int tiles) {
    const int x = static_cast<int>(word) * 64;
    const int count = std::min(64, image_.width - x);
    std::uint64_t sums = 0;
    std::array<std::uint64_t, kTile> last{};  // the last pixel of the word before
    for (int i = 0; i < rows_; ++i) {
      std::uint64_t* target = dark_.bits.data() + static_cast<std::size_t>(y_ + i) * dark_.words;
      const std::uint8_t* samples = image_.row(y_ + i) + x;
      const std::uint64_t bits =
          count == 64 ? dark_word(samples, thresholds) : dark_bits(samples, thresholds, count);
      if (word > 0) last[static_cast<std::size_t>(i)] = target[word - 1] >> 63U;
      sums += ones_of_bytes(bits ^ (bits << 1U | last[static_cast<std::size_t>(i)]));
      target[word] = bits;
    }
    for (int tile = 0; tile < tiles; ++tile) {
      changes[tile] = static_cast<std::uint8_t>(sums >> (8 * tile));
    }
  }

 private:
  const GrayView& image_;
  int y_;
  int rows_;
  DarkPixels& dark_;
};

// Marks all rows; returns the number of changes of colour in each tile.
Samples mark_tiles(const GrayView& image, const TileThresholds& thresholds, DarkPixels& dark) {
  const auto columns = static_cast<std::size_t>(thresholds.columns);
  Samples changes(thresholds.levels.size());
  for (std::size_t row = 0; row < dark.used.size(); ++row) {
    const std::uint8_t* levels = thresholds.levels.data() + row * columns;
    TileRowMarker marker(image, static_cast<int>(row), dark);
    dark.used[row] = used_words(levels, columns);
    for (std::size_t word = dark.used[row][0]; word < dark.used[row][1]; ++word) {
      if (!is_used(levels, columns, word)) continue;
      const std::size_t first = word * kTile;
      const std::size_t tiles = std::min<std::size_t>(kTile, columns - first);
      marker.mark(word, levels + first, changes.data() + row * columns + first,
                  static_cast<int>(tiles));
    }
  }
  return changes;
}

// How many changes of colour along the rows lie in tiles of each contrast.
std::array<std::size_t, 256> changes_by_contrast(const Samples& changes,
                                                 const TileThresholds& thresholds) {
  std::array<std::size_t, 256> sums{};
  for (std::size_t i = 0; i < changes.size(); ++i) sums[thresholds.contrast[i]] += changes[i];
  return sums;
}

// The least contrast that leaves at most so many changes.
int contrast_for(const std::array<std::size_t, 256>& changes, std::size_t max_changes) {
  std::size_t sum = 0;
  int contrast = 256;
  while (contrast > 0 && sum + changes[static_cast<std::size_t>(contrast - 1)] <= max_changes) {
    sum += changes[static_cast<std::size_t>(--contrast)];
  }
  return contrast;
}

}  // namespace

TileExtremes tile_extremes(const GrayView& image, const TileMask* searched) {
  TileExtremes extremes;
  extremes.columns = (image.width + kTile - 1) / kTile;
  extremes.rows = (image.height + kTile - 1) / kTile;
  const auto columns = static_cast<std::size_t>(extremes.columns);
  const auto width = static_cast<std::size_t>(image.width);
  extremes.low.resize(columns * static_cast<std::size_t>(extremes.rows), 255);
  extremes.high.resize(extremes.low.size());
  for (int row = 0; row < extremes.rows; ++row) {
    TileRows rows{};  // beyond the image its last row is repeated
    for (int i = 0; i < kTile; ++i) {
      rows[static_cast<std::size_t>(i)] = image.row(std::min(row * kTile + i, image.height - 1));
    }
    const std::size_t first = static_cast<std::size_t>(row) * columns;
    std::uint8_t* low = extremes.low.data() + first;
    std::uint8_t* high = extremes.high.data() + first;
    const std::uint8_t* wanted = searched != nullptr ? searched->tiles.data() + first : nullptr;
    std::size_t x = 0;
    for (; x + kLanes <= width; x += kLanes) {
      const std::size_t tile = x / kTile;
      if (wanted != nullptr) {
        std::uint16_t two = 0;
        std::memcpy(&two, wanted + tile, sizeof two);
        if (two == 0) continue;
      }
      two_tile_extremes(rows, x, low + tile, high + tile);
    }
    for (; x < width; x += kTile) {
      const std::size_t rest = std::min<std::size_t>(kTile, width - x);
      cut_tile_extremes(rows, x, rest, low + x / kTile, high + x / kTile);
    }
  }
  return extremes;
}

TileThresholds tile_thresholds(const TileExtremes& extremes, int min_contrast) {
  const Samples low = best_around<Least>(extremes.low, extremes.columns, extremes.rows);
  const Samples high = best_around<Greatest>(extremes.high, extremes.columns, extremes.rows);
  TileThresholds thresholds{extremes.columns, Samples(low.size()), Samples(low.size())};
  std::uint8_t* __restrict levels = thresholds.levels.data();
  std::uint8_t* __restrict contrast = thresholds.contrast.data();
  const auto least = static_cast<std::uint8_t>(std::clamp(min_contrast, 1, 255));
  for (std::size_t i = 0; i < low.size(); ++i) {
    const auto range = static_cast<std::uint8_t>(high[i] < low[i] ? 0 : high[i] - low[i]);
    const auto middle = static_cast<std::uint8_t>((low[i] + high[i] + 1) / 2);
    levels[i] = range < least ? std::uint8_t{0} : middle;
    contrast[i] = range;
  }
  return thresholds;
}

void keep_tiles(const TileMask& searched, TileThresholds& thresholds) {
  std::uint8_t* __restrict levels = thresholds.levels.data();
  const std::uint8_t* tiles = searched.tiles.data();
  const std::size_t count = thresholds.levels.size();
  for (std::size_t i = 0; i < count; ++i) {
    levels[i] = static_cast<std::uint8_t>(levels[i] & -tiles[i]);
  }
}

std::array<int, 2> tiles_in_row(const Quad& quad, int row, int columns) {
  const double y = kTile * (row + 0.5);
  double left = std::numeric_limits<double>::infinity();
  double right = -left;
  for (std::size_t i = 0; i < 4; ++i) {
    const PixelPoint a = quad[i];
    const PixelPoint b = quad[(i + 1) % 4];
    if ((a.y < y) == (b.y < y)) continue;
    const double x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
    left = std::min(left, x);
    right = std::max(right, x);
  }
  if (!(left < right)) return {0, 0};
  const auto column = [&](double x) {
    return static_cast<int>(std::clamp(std::ceil(x / kTile - 0.5), 0.0, 1.0 * columns));
  };
  return {column(left), column(right)};
}

void clear_tiles(const Quad& quad, TileThresholds& thresholds) {
  const int columns = thresholds.columns;
  const int rows = static_cast<int>(thresholds.levels.size()) / columns;
  for (int row = 0; row < rows; ++row) {
    const auto [begin, end] = tiles_in_row(quad, row, columns);
    std::uint8_t* levels = thresholds.levels.data() +
                           static_cast<std::size_t>(row) * static_cast<std::size_t>(columns);
    std::fill(levels + begin, levels + end, std::uint8_t{0});
  }
}

DarkPixels mark_dark(const GrayView& image, TileThresholds thresholds, std::size_t max_changes) {
  DarkPixels dark;
  dark.width = image.width;
  dark.height = image.height;
  dark.words = (static_cast<std::size_t>(image.width) + 63) / 64;
  dark.bits.resize(dark.words * static_cast<std::size_t>(image.height));
  dark.used.resize(static_cast<std::size_t>((image.height + kTile - 1) / kTile));
  const Samples changes = mark_tiles(image, thresholds, dark);
  if (std::accumulate(changes.begin(), changes.end(), std::size_t{0}) <= max_changes) return dark;
  const int contrast = contrast_for(changes_by_contrast(changes, thresholds), max_changes);
  for (std::size_t i = 0; i < thresholds.levels.size(); ++i) {
    if (thresholds.contrast[i] < contrast) thresholds.levels[i] = 0;
  }
  std::ranges::fill(dark.bits, 0);
  mark_tiles(image, thresholds, dark);
  return dark;
}

}  // namespace tagsmith::detail
