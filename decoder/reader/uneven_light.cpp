// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/uneven_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "decoder/image/morphology.hpp"
#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/tuning.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

constexpr float kDark = 0.02F;  // of the bright white: nothing is visible where there is less light

// Light along a row; where no pixel fell, that of the place before.
std::vector<float> light_of(const SymbolRows& rows, std::size_t row) {
  std::vector<float> light(rows.bins);
  for (std::size_t bin = 0; bin < rows.bins; ++bin) {
    const RowCell cell = rows.cell(row, bin);
    light[bin] = cell.count > 0 || bin == 0 ? cell.light : light[bin - 1];
  }
  return light;
}

// The light of the plate's white along a row. A window as wide as a digit is wider than any bar.
// Where all its spaces are of one module, blur leaves them darker than white: what is no darker
// than blur explains is taken from a window of two digits.
std::vector<float> white_of(const std::vector<float>& light, int bins_per_module, double blur) {
  const auto reach = static_cast<std::size_t>(kModulesPerDigit * bins_per_module / 2);
  const auto left = static_cast<float>(std::erf(0.5 / (std::numbers::sqrt2 * blur)));
  std::vector<float> white = closed(light, reach);
  const std::vector<float> wide = closed(light, 2 * reach);
  for (std::size_t i = 0; i < white.size(); ++i) {
    if (white[i] > left * wide[i]) white[i] = wide[i];
  }
  return white;
}

// The least white within a module of a place as a share of the greatest: less than 1 where the
// light changes at a place that is not exactly known.
float evenness_at(std::span<const float> white, std::size_t at, int bins_per_module) {
  const auto reach = static_cast<std::size_t>(bins_per_module);
  const std::size_t begin = at - std::min(at, reach);
  const auto [darkest, brightest] =
      std::ranges::minmax(white.subspan(begin, std::min(at + reach + 1, white.size()) - begin));
  return brightest > 0 ? darkest / brightest : 0;
}

// From the white of the plate above and below the bars the light of every digit's width, each the
// mean over so many places along the symbol and so many rows.
std::vector<float> light_of_margins(const GrayView& image, const FrameHomography& map,
                                    const SymbolLayout& layout) {
  constexpr int kRows = 5;
  const std::array<float, 256>& light = ToneCurve::of(image).light_table();
  std::vector<float> means;
  for (const double edge : {0.0, layout.bars_bottom}) {
    for (int first = 0; first < kModuleCount; first += kModulesPerDigit) {
      float sum = 0;
      for (int i = 0; i < kModulesPerDigit * kRows; ++i) {
        const double u = layout.width_share(first + i % kModulesPerDigit);
        const int row = i / kModulesPerDigit;
        const double v = edge + layout.bars_top * (0.3 + 0.1 * row);
        sum += light[static_cast<std::size_t>(sample_bilinear(image, map(u, v)))];
      }
      means.push_back(sum / (kModulesPerDigit * kRows));
    }
  }
  return means;
}

}  // namespace

bool is_unevenly_lit(const GrayView& image, const RefinedFrame& frame, const SymbolLayout& layout) {
  const FrameHomography map(frame.corners, frame.lens);
  std::vector<float> light = light_of_margins(image, map, layout);
  return quantile(light, 0.1) < static_cast<float>(kProfile.least_even) * quantile(light, 0.9);
}

double even_out(SymbolRows& rows, double blur) {
  std::vector<float> all;
  for (std::size_t row = 0; row < rows.rows; ++row) {
    const std::vector<float> white = white_of(light_of(rows, row), rows.bins_per_module, blur);
    for (std::size_t bin = 0; bin < rows.bins; ++bin) {
      rows.count[row * rows.bins + bin] *= evenness_at(white, bin, rows.bins_per_module);
    }
    all.insert(all.end(), white.begin(), white.end());
  }
  std::vector<float> ordered = all;
  const float bright = quantile(ordered, 0.9);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] < kDark * bright) rows.count[i] = 0;
    if (rows.count[i] > 0) rows.light[i] *= bright / all[i];
  }
  return static_cast<double>(bright);
}

}  // namespace tagsmith::detail
