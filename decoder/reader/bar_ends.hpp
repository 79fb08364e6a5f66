// SPDX-License-Identifier: Apache-2.0
// Where the bars of a symbol end, above and below: the one thing that tells a frame's upper and
// lower sides from other straight edges near by.
#pragma once

#include <array>
#include <optional>

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"

namespace tagsmith::detail {

// Bars in the unit square of a quadrilateral, v downwards along the bars.
struct BarField {
  Quad corners{};              // in the image, clockwise
  double first = 0, last = 1;  // u of the first and the last bar
  double top = 0, bottom = 1;  // v between which the bars are known to run
  LensDistortion lens = {};    // through which the bars are seen
};

BarField bar_field(const Quad& corners, const SymbolLayout& layout,
                   const LensDistortion& lens = {});

// A straight line across the bars.
struct BarEnds {
  double at_left = 0;   // v at u = 0
  double at_right = 0;  // v at u = 1
  double sigma_px = 0;  // of either, as a distance in the image

  double at(double u) const { return at_left + u * (at_right - at_left); }
};

// The line on which the bars end between v = `from`, which is among them, and `to`, outside: there
// rows stop being like those amid the bars and are white; what is dark there hides the end. Nothing
// where fewer than half of the symbol's eighths agree on one.
std::optional<BarEnds> find_bar_ends(const GrayView& image, const BarField& field, double from,
                                     double to);

// Whether the bars end above and below where the field has them end, to a pixel or two: a quick
// look.
bool bars_end_near(const GrayView& image, const BarField& field);

// What the bars' ends say of a frame's upper and lower side.
struct EndsVerdict {
  enum Kind {
    suited,   // both are where the bars' ends have them
    unknown,  // the bars do not show where they end, or the layout is none of the frame's
    hidden,   // one is something else's edge: `corners` has it where the bars' ends put it
    odd       // the bars end elsewhere, and no one side explains it
  };
  Kind kind = unknown;
  Quad corners{};
  std::size_t side = 0;  // 0 = upper, 2 = lower
  double sigma_px = 0;   // of that side's place at its ends
};

// Compares the bars' ends with a frame that is otherwise the symbol's own (corners clockwise from
// P).
EndsVerdict judge_by_bar_ends(const GrayView& image, const Quad& corners,
                              const SymbolLayout& layout, const LensDistortion& lens = {});

}  // namespace tagsmith::detail
