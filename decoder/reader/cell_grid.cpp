// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/wide.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

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
  const double left = (layout.quiet_zone_modules - kCellsBeyond) / modules;
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

// Where the pixels of an image lie in the unit square, and which of them are taken.
struct PixelSteps {
  std::array<float, 9> h{};  // unit_from_image
  int x_step = 1;
  int y_step = 1;
};

// How places in the unit square become cells.
struct CellMap {
  PlateLevels levels;
  float top = 0;
  float bands_per_height = 0;
  float modules = 0;
  float first_place = 0;
  float per_module = 0;
  float bands = 0;
  float bins = 0;
};

// The taken pixels of a row, quantity by quantity; what several loops hand on, so that the compiler
// can work out several pixels at a time.
struct RowPixels {
  explicit RowPixels(std::size_t width)
      : light(width), u(width), v(width), cell(width), shares(width) {}

  int count = 0;
  std::vector<float> light, u, v;
  std::vector<std::int32_t> cell;  // index; one past the last for pixels outside of all
  std::vector<Cell> shares;        // what each pixel adds to its cell
};

void look_up_light(const std::array<float, 256>& table, const std::uint8_t* samples, int step,
                   RowPixels& pixels) {
  float* light = pixels.light.data();
  const int count = pixels.count;
#pragma GCC unroll 8
  for (int i = 0; i < count; ++i) {
    light[i] = table[*samples];
    samples += step;
  }
}

TAGSMITH_WIDE void place_pixels(const PixelSteps& steps, int x_begin, int y, RowPixels& pixels) {
  const std::array<float, 9> h = steps.h;
  const auto fy = static_cast<float>(y);
  const float u0 = h[1] * fy + h[2];
  const float v0 = h[4] * fy + h[5];
  const float w0 = h[7] * fy + h[8];
  const int step = steps.x_step;
  const int count = pixels.count;
  float* u = pixels.u.data();
  float* v = pixels.v.data();
  for (int i = 0; i < count; ++i) {
    const auto fx = static_cast<float>(x_begin + i * step);
    const float scale = 1 / (h[6] * fx + w0);
    u[i] = (h[0] * fx + u0) * scale;
    v[i] = (h[3] * fx + v0) * scale;
  }
}

TAGSMITH_WIDE void assign_cells(const CellMap& to, RowPixels& pixels) {
  const CellMap map = to;
  const auto bins = static_cast<std::int32_t>(map.bins);
  const std::int32_t outside = static_cast<std::int32_t>(map.bands) * bins;
  const int count = pixels.count;
  const float* light = pixels.light.data();
  const float* u = pixels.u.data();
  const float* v = pixels.v.data();
  std::int32_t* cell = pixels.cell.data();
  Cell* shares = pixels.shares.data();
  for (int i = 0; i < count; ++i) {
    const float height = (v[i] - map.top) * map.bands_per_height;
    const float place = u[i] * map.modules - map.first_place;
    const float position = place * map.per_module;
    const float paper = map.levels.white.at(u[i], v[i]);
    const float contrast = paper - map.levels.black.at(u[i], v[i]);
    const float darkness = (paper - light[i]) / (contrast < 1e-3F ? 1e-3F : contrast);
    const bool inside =
        (height >= 0) & (position >= 0) & (height < map.bands) & (position < map.bins);
    const auto band = static_cast<std::int32_t>(inside ? height : 0);
    const auto bin = static_cast<std::int32_t>(inside ? position : 0);
    cell[i] = inside ? band * bins + bin : outside;
    shares[i].darkness = darkness;
    shares[i].squares = darkness * darkness;
    shares[i].place = place;
    shares[i].count = 1;
  }
}

void add_to_cells(const RowPixels& pixels, std::vector<Cell>& cells) {
  using Sums = float __attribute__((vector_size(sizeof(Cell))));
  const std::int32_t* cell = pixels.cell.data();
  const Cell* shares = pixels.shares.data();
  Cell* all = cells.data();
  const int count = pixels.count;
#pragma GCC unroll 4
  for (int i = 0; i < count; ++i) {
    Sums sums, share;
    std::memcpy(&sums, all + cell[i], sizeof sums);
    std::memcpy(&share, shares + i, sizeof share);
    sums += share;
    std::memcpy(static_cast<void*>(all + cell[i]), &sums, sizeof sums);
  }
}

// Light by sample.
const std::array<float, 256>& light_table() {
  static const auto kTable = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      table[i] = static_cast<float>(ToneCurve::srgb().light_of(static_cast<int>(i)));
    }
    return table;
  }();
  return kTable;
}

CellMap cell_map(const PlateLevels& levels, const SymbolLayout& layout, const CellGrid& grid) {
  const auto [top, bottom] = scanned_height(layout);
  return {levels,
          static_cast<float>(top),
          static_cast<float>(grid.bands) / static_cast<float>(bottom - top),
          static_cast<float>(kModuleCount + 2 * layout.quiet_zone_modules),
          static_cast<float>(layout.quiet_zone_modules - kCellsBeyond),
          static_cast<float>(grid.bins_per_module),
          static_cast<float>(grid.bands),
          static_cast<float>(grid.bins)};
}

PixelSteps pixel_steps(const FrameMap& image_from_unit, const Quad& region, int skip) {
  PixelSteps steps;
  const Homography unit_from_image = inverse(image_from_unit.flat());
  for (std::size_t i = 0; i < 9; ++i) steps.h[i] = static_cast<float>(unit_from_image.h[i]);
  const PixelPoint along = region[1] - region[0];
  (std::abs(along.x) < std::abs(along.y) ? steps.x_step : steps.y_step) = skip;
  return steps;
}

}  // namespace

std::array<double, 2> scanned_height(const SymbolLayout& layout) {
  constexpr double kClear = 0.07;  // of the bars' height at each end
  const double clear = kClear * (layout.bars_bottom - layout.bars_top);
  return {layout.bars_top + clear, layout.bars_bottom - clear};
}

CellGrid collect_cells(const GrayView& image, const FrameMap& image_from_unit,
                       const PlateLevels& levels, const SymbolLayout& layout,
                       const CellOptions& options) {
  CellGrid grid;
  grid.bands = options.bands;
  grid.bins_per_module = options.bins_per_module;
  grid.bins = static_cast<std::size_t>(options.bins_per_module * (kModuleCount + 2 * kCellsBeyond));
  grid.cells.resize(grid.bands * grid.bins + 1);
  const Quad region = scanned_region(image_from_unit, layout);
  const PixelSteps steps = pixel_steps(image_from_unit, region, options.skip);
  const CellMap map = cell_map(levels, layout, grid);
  const std::array<float, 256>& light = light_table();
  const auto [lowest, highest] =
      std::ranges::minmax(region, {}, [](const PixelPoint& corner) { return corner.y; });
  const int y_begin = std::max(0, static_cast<int>(std::floor(std::max(lowest.y, 0.0))));
  const int y_end = static_cast<int>(std::min(image.height - 1.0, std::ceil(highest.y)));
  const auto [leftmost, rightmost] =
      std::ranges::minmax(region, {}, [](const PixelPoint& corner) { return corner.x; });
  const double widest = std::clamp(rightmost.x - leftmost.x + 4, 0.0, 1.0 * image.width);
  RowPixels pixels(static_cast<std::size_t>(widest) + 1);
  for (int y = y_begin; y <= y_end; y += steps.y_step) {
    const std::uint8_t* row = image.row(y);
    const RowSpan span = span_of_row(region, y, image.width);
    const int begin = (span.begin + steps.x_step - 1) / steps.x_step * steps.x_step;
    pixels.count = std::max(0, (span.end - begin + steps.x_step) / steps.x_step);
    look_up_light(light, row + begin, steps.x_step, pixels);
    place_pixels(steps, begin, y, pixels);
    if (image_from_unit.bends()) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(pixels.count); ++i) {
        image_from_unit.correct(pixels.u[i], pixels.v[i]);
      }
    }
    assign_cells(map, pixels);
    add_to_cells(pixels, grid.cells);
  }
  grid.cells.pop_back();
  return grid;
}

}  // namespace tagsmith
