// SPDX-License-Identifier: Apache-2.0
// The light of a symbol's bars, straightened: rows across the bars' height, bins along the symbol.
#pragma once

#include <cstddef>
#include <vector>

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

// The pixels of one row and bin.
struct RowCell {
  float light = 0;  // mean, 0-1
  float place = 0;  // their mean place, bins from the begin of the first bin
  float count = 0;  // of pixels that may be used, doubtful ones in part; 0 = none, or hidden
};

// How many rows the bars' height is cut into: few, each of many pixels, or as many as hold a pixel
// of most bins.
enum class RowHeight { coarse, fine };

struct SymbolRows {
  // Cuts the rows out of a picture. `corners` are those of the frame's inner edge, P first.
  SymbolRows(const GrayView& image, const Quad& corners, const LensDistortion& lens,
             const SymbolLayout& layout, RowHeight row_height);

  RowCell cell(std::size_t row, std::size_t bin) const {
    const std::size_t at = row * bins + bin;
    return {light[at], place[at], count[at]};
  }
  // Middle of a row as a share of the frame's inner height.
  double height_of(std::size_t row) const;
  // A place in bins as modules from the symbol's first bar, and as a share of the frame's inner
  // width.
  double module_of(double at) const { return at / bins_per_module - modules_before; }
  double width_share_of(double at) const;

  SymbolLayout layout;
  FrameHomography image_from_frame;
  double height_px = 0;  // of the frame's inside
  double module_px = 0;  // width of a module in the middle of the frame
  int bins_per_module = 0;
  double modules_before = 0;   // of quiet zone before the symbol's first bar, and behind its last
  double top = 0, bottom = 0;  // of the rows, shares of the frame's inner height
  std::size_t rows = 0;
  std::size_t bins = 0;
  std::vector<float> light, place, count;  // of the cells, row by row
  // Mean place of a bin's pixels over all rows, bins; -1 = no pixel. Where the bars run along the
  // columns of pixels, all lie off the bin's middle.
  std::vector<float> middles;
};

// Leaves out what is plain where other rows show bars: no element is wider than four modules, so a
// longer window shows bars and spaces, or something in front of them, even if that covers most of
// the rows. Why: docs/decisions/0004-covered-tags.md.
void leave_out_plain(SymbolRows& rows);

}  // namespace tagsmith::detail
