// SPDX-License-Identifier: Apache-2.0
// Where the bars of a symbol end, above and below: the only feature that distinguishes a frame's
// upper and lower sides from other straight edges near by.
#pragma once

#include <cstddef>
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
  bool in_shadow = false;      // light changes along the bars: rows are compared by their own white
};

BarField bar_field(const Quad& corners, const SymbolLayout& layout, const LensDistortion& lens = {},
                   bool in_shadow = false);

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

// The same above and below, about where the field has them end.
struct BothEnds {
  BarField field;
  std::optional<BarEnds> upper{};
  std::optional<BarEnds> lower{};
};
BothEnds find_both_ends(const GrayView& image, const BarField& field);

// How lopsided the point spread is along the bars: how much farther downwards than upwards from
// their ends half of the light is spread, pixels, and the standard deviation of that. Nothing where
// fewer than half of the ends are in sight. `blur_px`: standard deviation of the point spread.
struct Lopsidedness {
  double px = 0;
  double sigma_px = 0;
};
std::optional<Lopsidedness> lopsidedness_along_bars(const GrayView& image, const BothEnds& ends,
                                                    double blur_px);

// How far the bars' ends may be from where the layout has them in a frame of these corners, pixels:
// templates' margins are rounded, lenses bend lines, and ends are blurred.
double ends_tolerance_px(const Quad& corners);

// Whether the bars end above and below where the field has them end, within a pixel or two: a quick
// check.
bool bars_end_near(const GrayView& image, const BarField& field);

// A frame's corners when its upper (0) or lower (2) side lies where the bars' ends put it, and the
// other three sides are those of `corners`. The field is the one that the ends were found in.
struct FrameByEnds {
  Quad corners{};
  double sigma_px = 0;  // of that side's place at its ends
};
FrameByEnds frame_by_ends(const Quad& corners, std::size_t side, const BarField& field,
                          const BarEnds& ends, const SymbolLayout& layout);

// What the bars' ends show about a frame's upper and lower side.
struct EndsVerdict {
  enum Kind {
    suited,        // both are where the bars' ends have them, or show the frame's own stroke where
                   // these are hidden
    other_layout,  // the bars end as far off above as below: the layout is not that of the frame
    hidden,        // one is something else's edge: `corners` has it where the bars' ends put it
    odd            // the bars end elsewhere, which no single side explains, or no end is visible
  };
  Kind kind = odd;
  Quad corners{};
  std::size_t side = 0;  // 0 = upper, 2 = lower
  double sigma_px = 0;   // of that side's place at its ends
};

// Compares the bars' ends with a frame that is otherwise the symbol's own (corners clockwise from
// P) and hardly differs from the one that they were looked for in.
EndsVerdict judge_by_bar_ends(const GrayView& image, const BothEnds& ends, const Quad& corners,
                              const SymbolLayout& layout);

// How far the bars' ends beside the upper (0) or lower (2) side are from where a frame of these
// corners has them, pixels; nothing where they are not in sight.
std::optional<double> off_bar_ends(const BothEnds& ends, std::size_t side, const Quad& corners,
                                   const SymbolLayout& layout);

// Whether a stroke like the frame's is visible beyond the upper (0) or lower (2) side of a frame of
// which that side was hidden: then something across the bars was mistaken for their ends.
bool is_stroke_beyond(const GrayView& image, const BarField& field, const SymbolLayout& layout,
                      std::size_t side);

}  // namespace tagsmith::detail
