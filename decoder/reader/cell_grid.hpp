// SPDX-License-Identifier: Apache-2.0
// The pixels of a symbol, summed over cells: bands across the bars' height, bins along the symbol.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "decoder/feature_frame/lens_bend.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith {

// Modules of quiet zone that cells are made of on both sides of the symbol.
inline constexpr double kCellsBeyond = 4;

// The part of the bars' height that is used, as shares of the frame's: clear of the bars' ends.
std::array<double, 2> scanned_height(const SymbolLayout& layout);

// Sums over a cell's pixels.
struct Cell {
  float darkness;  // 0 = white, 1 = black
  float squares;   // of the darkness
  float place;     // modules from the first bin's begin
  float count;
};

struct CellGrid {
  std::size_t bands = 0;
  std::size_t bins = 0;
  int bins_per_module = 0;
  std::vector<Cell> cells;  // band by band

  const Cell& at(std::size_t band, std::size_t bin) const { return cells[band * bins + bin]; }
};

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

// The light of the plate's white and of the frame's black.
struct PlateLevels {
  Field white, black;
};

struct CellOptions {
  int bins_per_module = 6;
  std::size_t bands = 16;
  int skip = 1;  // every so many pixels are taken along the bars; across them, all
};

CellGrid collect_cells(const GrayView& image, const FrameMap& image_from_unit,
                       const PlateLevels& levels, const SymbolLayout& layout,
                       const CellOptions& options);

}  // namespace tagsmith
