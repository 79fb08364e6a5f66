// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/symbol_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/point_spread.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

constexpr std::size_t kMaxBands = 16;
constexpr double kBeyond = 4;  // modules of quiet zone taken on both sides

// The part of the bars' height that is used, as shares of the frame's: clear of the bars' ends.
std::array<double, 2> scanned_height(const SymbolLayout& layout) {
  constexpr double kClear = 0.07;  // of the bars' height at each end
  const double clear = kClear * (layout.bars_bottom - layout.bars_top);
  return {layout.bars_top + clear, layout.bars_bottom - clear};
}

// A quantity over the frame, bilinear between its corners.
struct Field {
  float base, by_u, by_v, by_uv;

  // From the values at (0,0) (1,0) (1,1) (0,1).
  Field(double p, double f, double r, double q)
      : base(static_cast<float>(p)),
        by_u(static_cast<float>(f - p)),
        by_v(static_cast<float>(q - p)),
        by_uv(static_cast<float>(r - f - q + p)) {}

  float at(float u, float v) const { return base + u * by_u + v * (by_v + u * by_uv); }
};

struct Cell {
  float sum = 0;
  float sum_of_squares = 0;
  float place = 0;
  float count = 0;
};

// Cells by band (across the bars' height) and bin (along the symbol).
struct CellGrid {
  std::size_t bands = 0;
  std::size_t bins = 0;
  double bin_width = 0;  // modules
  double bins_per_module = 0;
  std::vector<Cell> cells;

  Cell& at(std::size_t band, std::size_t bin) { return cells[band * bins + bin]; }
  const Cell& at(std::size_t band, std::size_t bin) const { return cells[band * bins + bin]; }
};

// The x at which a row of pixels crosses a convex quadrilateral, widened to whole pixels; empty
// (begin > end) when it does not.
struct RowSpan {
  int begin = 0;
  int end = -1;
};

RowSpan span_of_row(const Quad& quad, int y, int width) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t i = 0; i < 4; ++i) {
    const PixelPoint a = quad[i];
    const PixelPoint b = quad[(i + 1) % 4];
    if ((a.y < y - 1 && b.y < y - 1) || (a.y > y + 1 && b.y > y + 1)) continue;
    const double slope = (b.x - a.x) / (std::abs(b.y - a.y) < 1e-9 ? 1e-9 : b.y - a.y);
    for (const double row : {y - 1.0, y + 1.0}) {
      const double inside = std::clamp(row, std::min(a.y, b.y), std::max(a.y, b.y));
      const double x = a.x + (inside - a.y) * slope;
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }
  if (!(low <= high)) return {};
  return {std::max(0, static_cast<int>(std::floor(std::max(low, -1.0)))),
          std::min(width - 1, static_cast<int>(std::ceil(std::min(high, 1.0 * width))))};
}

// The symbol with a little of its quiet zones, in the image.
Quad scanned_region(const FrameMap& image_from_unit, const SymbolLayout& layout) {
  const auto [top, bottom] = scanned_height(layout);
  const double modules = kModuleCount + 2 * layout.quiet_zone_modules;
  const double left = (layout.quiet_zone_modules - kBeyond) / modules;
  const Quad region{image_from_unit(left, top), image_from_unit(1 - left, top),
                    image_from_unit(1 - left, bottom), image_from_unit(left, bottom)};
  if (!image_from_unit.bends()) return region;
  // Between the corners, bowed sides reach further out.
  double farthest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const bool level = i % 2 == 0;
    const PixelPoint chord = 0.5 * (region[i] + region[(i + 1) % 4]);
    const PixelPoint middle = level ? image_from_unit(0.5, i == 0 ? top : bottom)
                                    : image_from_unit(i == 1 ? 1 - left : left, 0.5);
    farthest = std::max(farthest, distance(chord, middle));
  }
  return widened(region, farthest);
}

CellGrid collect(const GrayView& image, const FrameMap& image_from_unit, const Field& white,
                 const Field& black, const SymbolLayout& layout, int bins_per_module, int skip,
                 std::size_t bands) {
  const auto [scan_top, scan_bottom] = scanned_height(layout);
  const Quad region = scanned_region(image_from_unit, layout);
  const auto modules = static_cast<float>(kModuleCount + 2 * layout.quiet_zone_modules);
  CellGrid grid;
  grid.bands = bands;
  grid.bins = static_cast<std::size_t>(bins_per_module * (kModuleCount + 2 * kBeyond));
  grid.bin_width = 1.0 / bins_per_module;
  grid.bins_per_module = bins_per_module;
  grid.cells.resize(bands * grid.bins);
  std::array<float, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i) {
    light[i] = static_cast<float>(ToneCurve::srgb().light_of(static_cast<int>(i)));
  }
  std::array<float, 9> h{};
  const Homography unit_from_image = inverse(image_from_unit.flat());
  for (std::size_t i = 0; i < h.size(); ++i) h[i] = static_cast<float>(unit_from_image.h[i]);
  const auto top = static_cast<float>(scan_top);
  const float bands_per_height =
      static_cast<float>(bands) / static_cast<float>(scan_bottom - scan_top);
  const auto first_place = static_cast<float>(layout.quiet_zone_modules - kBeyond);
  const auto per_bin = static_cast<float>(bins_per_module);
  const int last_bin = static_cast<int>(grid.bins) - 1;
  const auto [lowest, highest] =
      std::ranges::minmax(region, {}, [](const PixelPoint& corner) { return corner.y; });
  const int y_begin = std::max(0, static_cast<int>(std::floor(std::max(lowest.y, 0.0))));
  const int y_end = static_cast<int>(std::min(image.height - 1.0, std::ceil(highest.y)));
  // Pixels are skipped along the bars, never across them.
  const PixelPoint along = region[1] - region[0];
  const int x_step = std::abs(along.x) < std::abs(along.y) ? skip : 1;
  const int y_step = std::abs(along.x) < std::abs(along.y) ? 1 : skip;
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<float> samples(width), heights(width), places(width);
  for (int y = y_begin; y <= y_end; y += y_step) {
    const std::uint8_t* row = image.row(y);
    const RowSpan span = span_of_row(region, y, image.width);
    const int begin = (span.begin + x_step - 1) / x_step * x_step;
    const auto fy = static_cast<float>(y);
    const float u0 = h[1] * fy + h[2];
    const float v0 = h[4] * fy + h[5];
    const float w0 = h[7] * fy + h[8];
    // First what the compiler can work out for several pixels at a time.
    std::size_t count = 0;
    for (int x = begin; x <= span.end; x += x_step) samples[count++] = light[row[x]];
    const auto place_all = [&](const auto& correct) {
      for (std::size_t i = 0; i < count; ++i) {
        const auto fx = static_cast<float>(begin + static_cast<int>(i) * x_step);
        const float scale = 1 / (h[6] * fx + w0);
        float u = (h[0] * fx + u0) * scale;
        float v = (h[3] * fx + v0) * scale;
        correct(u, v);
        heights[i] = (v - top) * bands_per_height;
        places[i] = u * modules - first_place;
        const float paper = white.at(u, v);
        const float contrast = paper - black.at(u, v);
        samples[i] = (paper - samples[i]) / (contrast < 1e-3F ? 1e-3F : contrast);
      }
    };
    if (image_from_unit.bends()) {
      place_all([&](float& u, float& v) { image_from_unit.correct(u, v); });
    } else {
      place_all([](float&, float&) {});
    }
    for (std::size_t i = 0; i < count; ++i) {
      const float position = places[i] * per_bin;
      if (!(heights[i] >= 0 && position >= 0)) continue;
      const int band = static_cast<int>(heights[i]);
      const int bin = static_cast<int>(position);
      if (band >= static_cast<int>(bands) || bin > last_bin) continue;
      Cell& cell = grid.at(static_cast<std::size_t>(band), static_cast<std::size_t>(bin));
      cell.sum += samples[i];
      cell.sum_of_squares += samples[i] * samples[i];
      cell.place += places[i];
      cell.count += 1;
    }
  }
  return grid;
}

// Variance of one pixel's darkness, pooled over the cells.
double pixel_variance(const CellGrid& grid) {
  double squares = 0;
  double freedom = 0;
  for (const Cell& cell : grid.cells) {
    if (cell.count < 2) continue;
    squares += static_cast<double>(cell.sum_of_squares - cell.sum * cell.sum / cell.count);
    freedom += static_cast<double>(cell.count - 1);
  }
  constexpr double kLeast = 1e-4;  // 1 % of the contrast: quantisation alone
  return freedom > 0 ? std::max(kLeast, squares / freedom) : 4e-4;
}

// Variance of one pixel's darkness in a cell that nothing hides in part: the middle one of the
// cells' own.
double clear_variance(const CellGrid& grid) {
  constexpr double kLeast = 1e-4;
  constexpr std::size_t kStep = 5;  // thousands of cells: every fifth tells the middle as well
  std::vector<float> variances;
  variances.reserve(grid.cells.size() / kStep + 1);
  for (std::size_t i = 0; i < grid.cells.size(); i += kStep) {
    const Cell& cell = grid.cells[i];
    if (cell.count < 3) continue;
    const float mean = cell.sum / cell.count;
    variances.push_back((cell.sum_of_squares - mean * cell.sum) / (cell.count - 1));
  }
  if (variances.empty()) return pixel_variance(grid);
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  return std::max(kLeast, static_cast<double>(*middle));
}

// The middle one of a bin's bands; nothing when no band has a pixel there.
std::optional<double> median_of_bands(const CellGrid& grid, std::size_t bin) {
  std::array<double, kMaxBands> means{};
  std::size_t count = 0;
  for (std::size_t band = 0; band < grid.bands; ++band) {
    const Cell& cell = grid.at(band, bin);
    if (cell.count > 0) means[count++] = static_cast<double>(cell.sum / cell.count);
  }
  if (count == 0) return std::nullopt;
  const auto middle = means.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(means.begin(), middle, means.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

// Four bins side by side, in the compiler's own vectors.
constexpr std::size_t kLanes = 4;
using Floats = float __attribute__((vector_size(4 * kLanes)));

// The pairs that sort a list of `Count` values when each is put in order in turn (Batcher 1968,
// "Sorting networks and their applications"): no branch depends on the values.
template <std::size_t Count>
constexpr auto sorting_network() {
  struct Network {
    std::array<std::array<std::uint8_t, 2>, Count * Count / 2> pairs{};
    std::size_t size = 0;
  } network;
  for (std::size_t p = 1; p < Count; p *= 2) {
    for (std::size_t k = p; k >= 1; k /= 2) {
      for (std::size_t j = k % p; j + k < Count; j += 2 * k) {
        for (std::size_t i = j; i < j + k && i + k < Count; ++i) {
          if (i / (2 * p) != (i + k) / (2 * p)) continue;
          network.pairs[network.size++] = {static_cast<std::uint8_t>(i),
                                           static_cast<std::uint8_t>(i + k)};
        }
      }
    }
  }
  return network;
}

// The middle ones of `Count` bands of the bins from `first` on, all of whose cells have pixels.
template <std::size_t Count>
Floats middle_of_bands(const CellGrid& grid, std::size_t first) {
  static constexpr auto kNetwork = sorting_network<Count>();
  std::array<Floats, Count> means{};
  for (std::size_t band = 0; band < Count; ++band) {
    const Cell* cell = &grid.at(band, first);
    const Floats sums{cell[0].sum, cell[1].sum, cell[2].sum, cell[3].sum};
    const Floats counts{cell[0].count, cell[1].count, cell[2].count, cell[3].count};
    means[band] = sums / counts;
  }
  for (std::size_t i = 0; i < kNetwork.size; ++i) {
    const auto [upper, lower] = kNetwork.pairs[i];
    const Floats a = means[upper], b = means[lower];
    means[upper] = a < b ? a : b;
    means[lower] = a < b ? b : a;
  }
  return means[Count / 2];
}

bool have_pixels(const CellGrid& grid, std::size_t first) {
  bool all = true;
  for (std::size_t band = 0; band < grid.bands; ++band) {
    for (std::size_t bin = first; bin < first + kLanes; ++bin) {
      all = all && grid.at(band, bin).count > 0;
    }
  }
  return all;
}

// The medians of all bins' bands.
std::vector<std::optional<double>> medians_of_bands(const CellGrid& grid) {
  std::vector<std::optional<double>> medians(grid.bins);
  std::size_t bin = 0;
  while (bin < grid.bins) {
    if (bin + kLanes > grid.bins || !have_pixels(grid, bin)) {
      medians[bin] = median_of_bands(grid, bin);
      ++bin;
      continue;
    }
    const Floats middle = grid.bands == kMaxBands ? middle_of_bands<kMaxBands>(grid, bin)
                                                  : middle_of_bands<kMaxBands / 2>(grid, bin);
    for (std::size_t i = 0; i < kLanes; ++i) medians[bin + i] = static_cast<double>(middle[i]);
    bin += kLanes;
  }
  return medians;
}

// What a bin's bands agree on, before covers are known.
struct Consensus {
  std::size_t bin = 0;
  double median = 0;
  double steepest = 0;  // change of darkness to either neighbouring bin
  double slope = 0;     // mean change of darkness from bin to bin there
};

std::vector<Consensus> consensus_of(const CellGrid& grid) {
  std::vector<Consensus> all;
  all.reserve(grid.bins);
  const std::vector<std::optional<double>> medians = medians_of_bands(grid);
  for (std::size_t bin = 0; bin < grid.bins; ++bin) {
    if (medians[bin]) all.push_back({bin, *medians[bin], 0, 0});
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double before = all[i == 0 ? 0 : i - 1].median;
    const double after = all[std::min(i + 1, all.size() - 1)].median;
    all[i].steepest = std::max(std::abs(all[i].median - before), std::abs(after - all[i].median));
    all[i].slope = (after - before) / 2;
  }
  return all;
}

// Whether a cell shows what the other bands agree on at its pixels' mean place.
bool agrees(const CellGrid& grid, const Cell& cell, const Consensus& with, double variance) {
  constexpr double kShading = 0.1;   // of the contrast: differences along a clean bar
  constexpr double kSlanted = 0.35;  // of the steepest change: what a slope does not tell of a bend
  const double per_pixel = 1 / static_cast<double>(cell.count);
  const double offset = static_cast<double>(cell.place) * per_pixel * grid.bins_per_module -
                        static_cast<double>(with.bin) - 0.5;
  const double expected = with.median + with.slope * offset;
  const double off = std::abs(static_cast<double>(cell.sum) * per_pixel - expected);
  const double systematic = kShading + kSlanted * with.steepest;
  return off <= systematic || (off - systematic) * (off - systematic) <= 16 * variance * per_pixel;
}

struct CellState {
  bool odd = false;      // disagrees with the other bands
  bool covered = false;  // lies on a stretch of its band that shows something in front of the bars
};

// Where something in front of the bars hides them. It disagrees with the other bands in spaces, if
// it is dark, and on bars, if it is light, so its stretch of a band is what lies between odd cells.
// Where it hides most of the height, the bands that are still clear look odd instead; they lie
// between its own odd cells, so all bands are taken for covered there.
std::vector<CellState> states_of(const CellGrid& grid, const std::vector<Consensus>& consensus,
                                 double variance) {
  constexpr double kBridge = 4.5;     // modules: more than the widest element
  constexpr double kLeastRun = 2;     // modules
  constexpr double kLeastOdd = 0.12;  // of a stretch's cells
  std::vector<CellState> states(grid.cells.size());
  const auto bridge = static_cast<std::size_t>(kBridge / grid.bin_width);
  for (std::size_t band = 0; band < grid.bands; ++band) {
    std::size_t begin = 0, last = 0, odd = 0;
    const auto close = [&] {
      const std::size_t run = last + 1 - begin;
      const bool long_enough = static_cast<double>(run) * grid.bin_width >= kLeastRun;
      if (odd == 0 || !long_enough ||
          static_cast<double>(odd) < kLeastOdd * static_cast<double>(run)) {
        return;
      }
      // A pixel's width of the cover's outline belongs to it too.
      const std::size_t from = begin == 0 ? 0 : begin - 1;
      const std::size_t to = std::min(grid.bins - 1, last + 1);
      for (std::size_t bin = from; bin <= to; ++bin) {
        states[band * grid.bins + bin].covered = true;
      }
    };
    for (const Consensus& with : consensus) {
      const Cell& cell = grid.at(band, with.bin);
      if (cell.count == 0 || agrees(grid, cell, with, variance)) continue;
      states[band * grid.bins + with.bin].odd = true;
      if (odd > 0 && with.bin - last > bridge) {
        close();
        odd = 0;
      }
      if (odd == 0) begin = with.bin;
      last = with.bin;
      ++odd;
    }
    close();
  }
  return states;
}

struct Sums {
  double darkness = 0;
  double place = 0;
  double count = 0;

  void add(const Cell& cell) {
    darkness += static_cast<double>(cell.sum);
    place += static_cast<double>(cell.place);
    count += static_cast<double>(cell.count);
  }
};

// One bin's cells by state.
struct BinSums {
  Sums clear;              // neither odd nor covered
  Sums even;               // not odd
  Sums covered;            // odd or not
  double odd = 0;          // pixels
  double odd_outside = 0;  // of them, outside of covers
  double seen = 0;
};

std::vector<BinSums> sums_of(const CellGrid& grid, const std::vector<Consensus>& consensus,
                             const std::vector<CellState>& states) {
  std::vector<BinSums> all(consensus.size());
  for (std::size_t i = 0; i < consensus.size(); ++i) {
    BinSums& sums = all[i];
    for (std::size_t band = 0; band < grid.bands; ++band) {
      const Cell& cell = grid.at(band, consensus[i].bin);
      const CellState state = states[band * grid.bins + consensus[i].bin];
      const auto count = static_cast<double>(cell.count);
      sums.seen += count;
      if (state.covered) sums.covered.add(cell);
      if (!state.odd) sums.even.add(cell);
      if (!state.odd && !state.covered) sums.clear.add(cell);
      if (state.odd) sums.odd += count;
      if (state.odd && !state.covered) sums.odd_outside += count;
    }
  }
  return all;
}

// Variance along the symbol, over a window.
class Modulation {
 public:
  void add(double value, double sign) {
    count_ += sign;
    sum_ += sign * value;
    squares_ += sign * value * value;
  }

  double variance() const {
    return count_ < 2 ? 0 : std::max(0.0, squares_ / count_ - sum_ * sum_ / (count_ * count_));
  }

 private:
  double count_ = 0, sum_ = 0, squares_ = 0;
};

// Whether a bin's covered cells are to be left out: where they are plain along the symbol and the
// clear ones show bars, for no seven modules are without both bars and spaces. Where it is the
// other way round, the clear cells are the cover.
std::vector<bool> certain_covers(const std::vector<BinSums>& sums, double bin_width) {
  constexpr double kWindow = 4;     // modules to either side
  constexpr double kPlainer = 0.4;  // variance of covered cells against that of clear ones
  const auto reach = static_cast<std::size_t>(kWindow / bin_width);
  std::vector<bool> certain(sums.size());
  Modulation clear, covered;
  const auto count_in = [&](const BinSums& bin, double sign) {
    if (bin.clear.count > 0) clear.add(bin.clear.darkness / bin.clear.count, sign);
    if (bin.covered.count > 0) covered.add(bin.covered.darkness / bin.covered.count, sign);
  };
  for (std::size_t i = 0; i < std::min(reach, sums.size()); ++i) count_in(sums[i], 1);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (i + reach < sums.size()) count_in(sums[i + reach], 1);
    if (i > reach) count_in(sums[i - reach - 1], -1);
    certain[i] = covered.variance() < kPlainer * clear.variance();
  }
  return certain;
}

// The bins from the bands that agree.
ScanProfile combine_all(const CellGrid& grid, double variance) {
  constexpr double kModelError = 0.02;  // of the contrast: what averaging cannot take away
  constexpr double kHidden = 4;         // variance that says nothing
  constexpr double kLeastUsed = 0.2;    // of the bars' height
  const std::vector<Consensus> consensus = consensus_of(grid);
  const std::vector<CellState> states = states_of(grid, consensus, clear_variance(grid));
  const std::vector<BinSums> sums = sums_of(grid, consensus, states);
  const std::vector<bool> certain = certain_covers(sums, grid.bin_width);
  ScanProfile profile;
  profile.reserve(consensus.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const BinSums& bin = sums[i];
    const Sums& used = certain[i] ? bin.clear : bin.even;
    const double odd = certain[i] ? bin.odd_outside : bin.odd;
    if (used.count < kLeastUsed * bin.seen) {
      const double middle = (static_cast<double>(consensus[i].bin) + 0.5) * grid.bin_width;
      profile.push_back({middle - kBeyond, consensus[i].median, kHidden, 0});
      continue;
    }
    // Where the height disagrees with itself the median may have taken the wrong side: the doubt
    // grows from nothing at full agreement to the whole contrast where half disagrees.
    const double doubt = std::min(1.0, 2 * odd / (odd + used.count));
    profile.push_back(
        {used.place / used.count - kBeyond, used.darkness / used.count,
         variance / used.count + kModelError * kModelError + doubt * doubt * doubt * doubt,
         used.count / bin.seen});
  }
  return profile;
}

// Width of a module in the middle of the frame, pixels.
double module_at_middle(const FrameMap& image_from_unit, const SymbolLayout& layout) {
  const double half = 0.5 / (kModuleCount + 2 * layout.quiet_zone_modules);
  return distance(image_from_unit(0.5 - half, 0.5), image_from_unit(0.5 + half, 0.5));
}

}  // namespace

TurnedFrame turned_to(const RefinedFrame& frame, std::size_t first_corner) {
  TurnedFrame turned;
  for (std::size_t i = 0; i < 4; ++i) {
    turned.corners[i] = frame.corners[(first_corner + i) % 4];
    turned.sides[i] = frame.sides[(first_corner + i) % 4];
  }
  return turned;
}

double blur_across(const std::array<FrameSide, 4>& sides, double module_px, double bin_width) {
  const double blur_px = (sides[1].blur_px + sides[3].blur_px) / 2;
  return std::sqrt(std::pow(blur_px / std::max(module_px, 1e-3), 2) + bin_width * bin_width / 12);
}

SymbolProfile profile_symbol(const GrayView& image, const RefinedFrame& frame,
                             std::size_t first_corner, const SymbolLayout& layout) {
  const auto [corners, sides] = turned_to(frame, first_corner);
  const FrameMap image_from_unit(corners, frame.lens);
  SymbolProfile profile;
  profile.module_px = module_at_middle(image_from_unit, layout);
  const double frame_height =
      (distance(corners[0], corners[3]) + distance(corners[1], corners[2])) / 2;
  // Two bins a pixel and six a module lose nothing; more than 40 to 80 rows of pixels add little.
  const int bins_per_module =
      std::clamp(static_cast<int>(std::lround(2.5 * profile.module_px)), 3, 6);
  const auto [scan_top, scan_bottom] = scanned_height(layout);
  const int skip = std::max(1, static_cast<int>(frame_height * (scan_bottom - scan_top) / 40));
  const Field white(sides[0].white_begin, sides[0].white_end, sides[2].white_begin,
                    sides[2].white_end);
  const Field black(sides[0].black_begin, sides[0].black_end, sides[2].black_begin,
                    sides[2].black_end);
  const double rows = frame_height * (scan_bottom - scan_top) / skip;
  const std::size_t bands = rows < 40 ? kMaxBands / 2 : kMaxBands;
  const CellGrid grid =
      collect(image, image_from_unit, white, black, layout, bins_per_module, skip, bands);
  const double variance = pixel_variance(grid);
  profile.bins = combine_all(grid, variance);
  set_spreads(image_from_unit, layout, profile.bins);
  profile.blur = blur_across(sides, profile.module_px, grid.bin_width);
  return profile;
}

}  // namespace tagsmith
