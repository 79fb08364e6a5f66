// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/symbol_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/tuning.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/base/wide.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// Which pixels count: every one of a small frame, fewer along the bars of a large one, where more
// would add little.
struct PixelSteps {
  int x = 1;
  int y = 1;
};

PixelSteps pixel_steps(const SymbolRows& rows, const Quad& corners) {
  const double along_bar = rows.height_px * (rows.bottom - rows.top);
  const int skip =
      std::max(1, static_cast<int>(along_bar / (kProfile.row_px * static_cast<double>(rows.rows))));
  const PixelPoint along = corners[1] - corners[0];
  return std::abs(along.x) < std::abs(along.y) ? PixelSteps{skip, 1} : PixelSteps{1, skip};
}

std::size_t row_count(double height_px, RowHeight row_height) {
  if (row_height == RowHeight::coarse) return height_px < 40 ? 8 : 16;
  return static_cast<std::size_t>(std::clamp(std::lround(height_px / kProfile.row_px), 16L, 64L));
}

// The pixels that the rows may touch, bowed sides included.
PixelBox box_of(const SymbolRows& rows, const GrayView& image) {
  const double left = rows.width_share_of(0);
  const double right = rows.width_share_of(static_cast<double>(rows.bins));
  std::vector<PixelPoint> outline;
  for (const double u : {left, 0.5, right}) {
    for (const double v : {rows.top, 0.5, rows.bottom}) {
      outline.push_back(rows.image_from_frame(u, v));
    }
  }
  return box_around(outline, 0, image);
}

// Where pixels of an image fall among the rows: an affine map of the unit square.
struct CellPlaces {
  std::array<float, 9> frame_from_image{};
  int rows, bins;
  float rows_per_height, top_row;  // row = rows_per_height v - top_row
  float bins_per_width, first_bin;

  CellPlaces(const SymbolRows& of)
      : rows(static_cast<int>(of.rows)),
        bins(static_cast<int>(of.bins)),
        rows_per_height(static_cast<float>(static_cast<double>(of.rows) / (of.bottom - of.top))),
        top_row(static_cast<float>(of.top) * rows_per_height),
        bins_per_width(static_cast<float>(of.layout.modules() * of.bins_per_module)),
        first_bin(static_cast<float>((of.layout.quiet_zone_modules - of.modules_before) *
                                     of.bins_per_module)) {
    const Homography inverted = inverse(of.image_from_frame.flat());
    std::ranges::transform(inverted.h, frame_from_image.begin(),
                           [](double a) { return static_cast<float>(a); });
  }
};

// The places in the unit square of pixels of row y from x on, as if no lens bent them. A loop of
// its own, for the compiler's vectors.
TAGSMITH_WIDE void places_in_unit(const std::array<float, 9>& h, int x, int x_step, int y,
                                  std::span<float> u, std::span<float> v) {
  const auto fy = static_cast<float>(y);
  const float u0 = h[1] * fy + h[2], v0 = h[4] * fy + h[5], w0 = h[7] * fy + h[8];
  const float u1 = h[0], v1 = h[3], w1 = h[6];
  float* to_u = u.data();
  float* to_v = v.data();
  const auto count = static_cast<int>(u.size());
  for (int i = 0; i < count; ++i) {
    const auto fx = static_cast<float>(x + i * x_step);
    const float scale = 1 / (w1 * fx + w0);
    to_u[i] = (u1 * fx + u0) * scale;
    to_v[i] = (v1 * fx + v0) * scale;
  }
}

// Of places in the unit square the cells that hold them, -1 = none, and their places in bins, which
// take the place of `u`.
TAGSMITH_WIDE void cells_at(const CellPlaces& places, std::span<float> u, std::span<const float> v,
                            std::span<std::int32_t> cells) {
  const auto rows = static_cast<float>(places.rows), bins = static_cast<float>(places.bins);
  const float rows_per_height = places.rows_per_height, top_row = places.top_row;
  const float bins_per_width = places.bins_per_width, first_bin = places.first_bin;
  const std::int32_t in_row = places.bins;
  float* to_bin = u.data();
  const float* from_v = v.data();
  std::int32_t* to_cell = cells.data();
  const auto count = static_cast<int>(cells.size());
  TAGSMITH_INDEPENDENT_TURNS
  for (int i = 0; i < count; ++i) {
    const float row = from_v[i] * rows_per_height - top_row;
    const float bin = to_bin[i] * bins_per_width - first_bin;
    const bool is_held = (row >= 0) & (row < rows) & (bin >= 0) & (bin < bins);
    const float held_row = is_held ? row : 0, held_bin = is_held ? bin : 0;
    const std::int32_t cell =
        static_cast<std::int32_t>(held_row) * in_row + static_cast<std::int32_t>(held_bin);
    to_bin[i] = bin;
    to_cell[i] = is_held ? cell : -1;
  }
}

// Sums of the pixels in the cells that hold their centres.
void add_pixels(const GrayView& image, const Quad& corners, SymbolRows& rows) {
  const std::array<float, 256>& light = ToneCurve::of(image).light_table();
  const PixelBox box = box_of(rows, image);
  const PixelSteps steps = pixel_steps(rows, corners);
  const CellPlaces places(rows);
  const auto width = static_cast<std::size_t>((box.width() + steps.x - 1) / steps.x);
  std::vector<float> u(width), v(width);
  std::vector<std::int32_t> cells(width);
  float* const sum_of_light = rows.light.data();
  float* const sum_of_places = rows.place.data();
  float* const count = rows.count.data();
  for (int y = box.top; y < box.bottom; y += steps.y) {
    const std::uint8_t* sample = image.row(y) + box.left;
    places_in_unit(places.frame_from_image, box.left, steps.x, y, u, v);
    if (rows.image_from_frame.bends()) {
      for (std::size_t i = 0; i < width; ++i) rows.image_from_frame.correct(u[i], v[i]);
    }
    cells_at(places, u, v, cells);
    for (std::size_t i = 0; i < width; ++i, sample += steps.x) {
      if (cells[i] < 0) continue;
      sum_of_light[cells[i]] += light[*sample];
      sum_of_places[cells[i]] += u[i];
      count[cells[i]] += 1;
    }
  }
}

// Makes means of sums.
void divide(SymbolRows& rows) {
  for (std::size_t i = 0; i < rows.count.size(); ++i) {
    const float count = std::max(1.0F, rows.count[i]);
    rows.light[i] /= count;
    rows.place[i] /= count;
  }
}

std::vector<float> middles_of(const SymbolRows& rows) {
  std::vector<float> middles(rows.bins), count(rows.bins);
  for (std::size_t i = 0, row = 0; row < rows.rows; ++row) {
    for (std::size_t bin = 0; bin < rows.bins; ++bin, ++i) {
      middles[bin] += rows.count[i] * rows.place[i];
      count[bin] += rows.count[i];
    }
  }
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    middles[bin] = count[bin] > 0 ? middles[bin] / count[bin] : -1.0F;
  }
  return middles;
}

}  // namespace

SymbolRows::SymbolRows(const GrayView& image, const Quad& corners, const LensDistortion& lens,
                       const SymbolLayout& of, RowHeight row_height)
    : layout(of), image_from_frame(corners, lens) {
  const double half = 0.5 / layout.modules();
  module_px = distance(image_from_frame(0.5 - half, 0.5), image_from_frame(0.5 + half, 0.5));
  height_px = detail::height_of(corners);
  // Often an occluder is visible only at the bars' ends.
  const double clear = std::min(kProfile.ends * layout.bar_height(), kProfile.ends_px / height_px);
  top = layout.bars_top + clear;
  bottom = layout.bars_bottom - clear;
  rows = row_count(height_px * (bottom - top), row_height);
  // Two bins a pixel and six a module lose no information.
  bins_per_module = std::clamp(static_cast<int>(std::lround(2.5 * module_px)), 3, 6);
  modules_before = std::min(kProfile.beyond, layout.quiet_zone_modules);
  bins = static_cast<std::size_t>((kModuleCount + 2 * modules_before) * bins_per_module);
  for (std::vector<float>* of_cells : {&light, &place, &count}) of_cells->resize(rows * bins);
  add_pixels(image, corners, *this);
  divide(*this);
  middles = middles_of(*this);
}

double SymbolRows::height_of(std::size_t row) const {
  return top + (bottom - top) * (static_cast<double>(row) + 0.5) / static_cast<double>(rows);
}

double SymbolRows::width_share_of(double at) const { return layout.width_share(module_of(at)); }

namespace {

// How far the light of every window of a row is from an even slope: the variance that is left; -1
// where too little of the window is seen. A window reaches from its bin on.
std::vector<float> unevenness_of(const SymbolRows& rows, std::size_t row, std::size_t window) {
  struct Sums {
    double w = 0, x = 0, xx = 0, l = 0, ll = 0, lx = 0;
  };
  std::vector<Sums> sums(rows.bins + 1);
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    const RowCell cell = rows.cell(row, bin);
    const auto w = static_cast<double>(cell.count);
    const auto x = static_cast<double>(bin);
    const auto l = static_cast<double>(cell.light);
    const Sums& s = sums[bin];
    sums[bin + 1] = {s.w + w,     s.x + w * x,      s.xx + w * x * x,
                     s.l + w * l, s.ll + w * l * l, s.lx + w * l * x};
  }
  std::vector<float> left(rows.bins, -1.0F);
  for (std::size_t begin = 0; begin + window <= rows.bins; ++begin) {
    const Sums& a = sums[begin];
    const Sums& b = sums[begin + window];
    const double w = b.w - a.w;
    if (w < static_cast<double>(window) / 4) continue;
    const double x = (b.x - a.x) / w, l = (b.l - a.l) / w;
    const double xx = (b.xx - a.xx) / w - x * x;
    const double lx = (b.lx - a.lx) / w - l * x;
    const double ll = (b.ll - a.ll) / w - l * l;
    left[begin] = static_cast<float>(std::max(0.0, ll - (xx > 0 ? lx * lx / xx : 0)));
  }
  return left;
}

}  // namespace

void leave_out_plain(SymbolRows& rows) {
  const auto window = kNearModules * static_cast<std::size_t>(rows.bins_per_module);
  std::vector<std::vector<float>> uneven;
  for (std::size_t row = 0; row < rows.rows; ++row) {
    uneven.push_back(unevenness_of(rows, row, window));
  }
  std::vector<double> showing(rows.bins);
  for (std::size_t begin = 0; begin < rows.bins; ++begin) {
    std::vector<double> here;
    for (const auto& row : uneven) {
      if (row[begin] >= 0) here.push_back(static_cast<double>(row[begin]));
    }
    if (here.empty()) continue;
    showing[begin] = quantile(here, kProfile.showing);
  }
  for (std::size_t row = 0; row < rows.rows; ++row) {
    for (std::size_t begin = 0; begin + window <= rows.bins; ++begin) {
      const double left = static_cast<double>(uneven[row][begin]);
      if (left < 0 || left > kProfile.plain * showing[begin]) continue;
      for (std::size_t i = 0; i < window; ++i) rows.count[row * rows.bins + begin + i] = 0;
    }
  }
}

}  // namespace tagsmith::detail
