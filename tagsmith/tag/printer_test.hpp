// SPDX-License-Identifier: Apache-2.0
// The geometry of a printer's test sheet, which drawing and measuring share.
#pragma once

#include <array>
#include <vector>

#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// A square of a tone: the share of the area that ink covers.
struct TonePatch {
  Rectangle square;
  double cover = 0;
};

// All in the sheet's frame: origin at the upper left corner of what is printed, x to the right, y
// down, metres. Marks are tags, so that a scan is found and turned by reading it.
struct PrinterTest {
  double width = 0;
  double height = 0;
  std::vector<TagDrawing> marks;
  std::vector<Digits> codes;          // of the marks, in their order
  std::vector<Rectangle> upright;     // bars of growing width, apart from each other
  std::vector<Rectangle> lying;       // the same, lying
  std::vector<TonePatch> tones;       // from no ink to full ink
  std::array<Rectangle, 2> scales{};  // long scales: their lengths across and down
};

PrinterTest printer_test();

// The white that belongs to a bar's measurement on either side, metres.
inline constexpr double kBarSurround = 0.0025;

}  // namespace tagsmith::detail
