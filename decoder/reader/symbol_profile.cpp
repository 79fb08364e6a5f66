// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/symbol_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "decoder/image/tone_curve.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

constexpr std::size_t kBands = 8;
constexpr double kBeyond = 4;  // modules of quiet zone taken on both sides

// The part of the bars' height that is used, as shares of the frame's: clear of the bars' ends.
std::array<double, 2> scanned_height(const SymbolLayout& layout) {
  constexpr double kClear = 0.07;  // of the bars' height at each end
  const double clear = kClear * (layout.bars_bottom - layout.bars_top);
  return {layout.bars_top + clear, layout.bars_bottom - clear};
}

// Light of plate and ink over the frame, from its upper and lower sides.
struct Levels {
  FrameSide top;
  FrameSide bottom;

  double white(double u, double v) const {
    return (1 - v) * ((1 - u) * top.white_begin + u * top.white_end) +
           v * ((1 - u) * bottom.white_end + u * bottom.white_begin);
  }
  double black(double u, double v) const {
    return (1 - v) * ((1 - u) * top.black_begin + u * top.black_end) +
           v * ((1 - u) * bottom.black_end + u * bottom.black_begin);
  }
};

struct Cell {
  double sum = 0;
  double sum_of_squares = 0;
  double place = 0;
  int count = 0;
};

// Cells by band (across the bars' height) and bin (along the symbol).
struct CellGrid {
  std::size_t bins = 0;
  double bin_width = 0;  // modules
  std::vector<Cell> cells;

  Cell& at(std::size_t band, std::size_t bin) { return cells[band * bins + bin]; }
  const Cell& at(std::size_t band, std::size_t bin) const { return cells[band * bins + bin]; }
};

CellGrid collect(const GrayView& image, const Homography& image_from_unit, const Levels& levels,
                 const SymbolLayout& layout, int bins_per_module, double thinning) {
  const ToneCurve& tone = ToneCurve::srgb();
  const auto [scan_top, scan_bottom] = scanned_height(layout);
  const Homography unit_from_image = inverse(image_from_unit);
  const Quad region{image_from_unit(0, scan_top), image_from_unit(1, scan_top),
                    image_from_unit(1, scan_bottom), image_from_unit(0, scan_bottom)};
  const double modules = kModuleCount + 2 * layout.quiet_zone_modules;
  CellGrid grid;
  grid.bins = static_cast<std::size_t>(bins_per_module * (kModuleCount + 2 * kBeyond));
  grid.bin_width = 1.0 / bins_per_module;
  grid.cells.resize(kBands * grid.bins);
  double left = region[0].x, right = region[0].x, top = region[0].y, bottom = region[0].y;
  for (const PixelPoint& corner : region) {
    left = std::min(left, corner.x);
    right = std::max(right, corner.x);
    top = std::min(top, corner.y);
    bottom = std::max(bottom, corner.y);
  }
  const int x_begin = std::max(0, static_cast<int>(std::floor(left)));
  const int x_end = std::min(image.width - 1, static_cast<int>(std::ceil(right)));
  const int y_begin = std::max(0, static_cast<int>(std::floor(top)));
  const int y_end = std::min(image.height - 1, static_cast<int>(std::ceil(bottom)));
  // Pixels are skipped along the bars, never across them.
  const PixelPoint along = region[1] - region[0];
  const int skip = std::max(1, static_cast<int>(thinning));
  const int x_step = std::abs(along.x) < std::abs(along.y) ? skip : 1;
  const int y_step = std::abs(along.x) < std::abs(along.y) ? 1 : skip;
  for (int y = y_begin; y <= y_end; y += y_step) {
    const std::uint8_t* row = image.row(y);
    for (int x = x_begin; x <= x_end; x += x_step) {
      const PixelPoint unit = unit_from_image(x, y);
      if (!(unit.y >= scan_top && unit.y < scan_bottom)) continue;
      const double place = unit.x * modules - layout.quiet_zone_modules;
      const double position = (place + kBeyond) / grid.bin_width;
      if (!(position >= 0 && position < static_cast<double>(grid.bins))) continue;
      const double white = levels.white(unit.x, unit.y);
      const double black = levels.black(unit.x, unit.y);
      const double darkness = (white - tone.light_of(row[x])) / std::max(white - black, 1e-3);
      const auto band =
          static_cast<std::size_t>((unit.y - scan_top) / (scan_bottom - scan_top) * kBands);
      Cell& cell = grid.at(std::min(band, kBands - 1), static_cast<std::size_t>(position));
      cell.sum += darkness;
      cell.sum_of_squares += darkness * darkness;
      cell.place += place;
      ++cell.count;
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
    squares += cell.sum_of_squares - cell.sum * cell.sum / cell.count;
    freedom += cell.count - 1;
  }
  constexpr double kLeast = 1e-4;  // 1 % of the contrast: quantisation alone
  return freedom > 0 ? std::max(kLeast, squares / freedom) : 4e-4;
}

// The middle one of a bin's bands; nothing when no band has a pixel there.
std::optional<double> median_of_bands(const CellGrid& grid, std::size_t bin) {
  std::array<double, kBands> means{};
  std::size_t count = 0;
  for (std::size_t band = 0; band < kBands; ++band) {
    const Cell& cell = grid.at(band, bin);
    if (cell.count > 0) means[count++] = cell.sum / cell.count;
  }
  if (count == 0) return std::nullopt;
  const auto middle = means.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(means.begin(), middle, means.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

// One bin from its bands: those that agree with their median. `slope` is the change of darkness to
// the neighbouring bins, which pixels at other places within the bin show too.
std::optional<ScanBin> combine(const CellGrid& grid, std::size_t bin, double median, double slope,
                               double variance) {
  constexpr double kShading = 0.1;      // of the contrast: differences along a clean bar
  constexpr double kModelError = 0.02;  // of the contrast: what averaging cannot take away
  double sum = 0, place = 0;
  int pixels = 0;
  int seen = 0;
  for (std::size_t band = 0; band < kBands; ++band) {
    const Cell& cell = grid.at(band, bin);
    if (cell.count == 0) continue;
    seen += cell.count;
    const double tolerance = kShading + slope + 4 * std::sqrt(variance / cell.count);
    if (std::abs(cell.sum / cell.count - median) > tolerance) continue;
    sum += cell.sum;
    place += cell.place;
    pixels += cell.count;
  }
  if (pixels == 0) return std::nullopt;
  // Where the height disagrees with itself the median may have taken the wrong side: the doubt
  // grows from nothing at full agreement to the whole contrast where half disagrees.
  const double agreement = static_cast<double>(pixels) / seen;
  const double doubt = std::min(1.0, 2 * (1 - agreement));
  return ScanBin{place / pixels, sum / pixels,
                 variance / pixels + kModelError * kModelError + doubt * doubt * doubt * doubt,
                 agreement};
}

ScanProfile combine_all(const CellGrid& grid, double variance) {
  std::vector<std::size_t> used;
  std::vector<double> medians;
  for (std::size_t bin = 0; bin < grid.bins; ++bin) {
    const std::optional<double> median = median_of_bands(grid, bin);
    if (!median) continue;
    used.push_back(bin);
    medians.push_back(*median);
  }
  ScanProfile profile;
  profile.reserve(used.size());
  for (std::size_t i = 0; i < used.size(); ++i) {
    const double before = medians[i == 0 ? 0 : i - 1];
    const double after = medians[std::min(i + 1, used.size() - 1)];
    const double slope = std::max(std::abs(medians[i] - before), std::abs(after - medians[i]));
    const auto bin = combine(grid, used[i], medians[i], slope, variance);
    if (bin) profile.push_back(*bin);
  }
  return profile;
}

// Width of a module in the middle of the frame, pixels.
double module_at_middle(const Homography& image_from_unit, const SymbolLayout& layout) {
  const double half = 0.5 / (kModuleCount + 2 * layout.quiet_zone_modules);
  return distance(image_from_unit(0.5 - half, 0.5), image_from_unit(0.5 + half, 0.5));
}

}  // namespace

SymbolProfile profile_symbol(const GrayView& image, const RefinedFrame& frame,
                             std::size_t first_corner, const SymbolLayout& layout) {
  Quad corners{};
  std::array<FrameSide, 4> sides{};
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i] = frame.corners[(first_corner + i) % 4];
    sides[i] = frame.sides[(first_corner + i) % 4];
  }
  const Homography image_from_unit = homography_to(corners);
  SymbolProfile profile;
  profile.module_px = module_at_middle(image_from_unit, layout);
  const double frame_height =
      (distance(corners[0], corners[3]) + distance(corners[1], corners[2])) / 2;
  // Two bins a pixel lose nothing; more than 60 rows of pixels add little.
  const int bins_per_module =
      std::clamp(static_cast<int>(std::lround(2.5 * profile.module_px)), 3, 10);
  const auto [scan_top, scan_bottom] = scanned_height(layout);
  const double thinning = frame_height * (scan_bottom - scan_top) / 60;
  const Levels levels{sides[0], sides[2]};
  const CellGrid grid = collect(image, image_from_unit, levels, layout, bins_per_module, thinning);
  const double variance = pixel_variance(grid);
  profile.bins = combine_all(grid, variance);
  const double smear = grid.bin_width * grid.bin_width / 12;
  const double blur_px = (sides[1].blur_px + sides[3].blur_px) / 2;
  profile.blur = std::sqrt(std::pow(blur_px / std::max(profile.module_px, 1e-3), 2) + smear);
  return profile;
}

}  // namespace tagsmith
