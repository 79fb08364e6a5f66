// SPDX-License-Identifier: Apache-2.0
// How a printer changes what it prints, and the correction for it: dots, growth of bars.
#pragma once

#include <string>

#include "tagsmith/tag/drawing.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// ---- How a printer changes what it prints.

// Printed length over drawn length, across and down the page as it leaves the printer.
struct PrinterScale {
  double right = 1;
  double down = 1;

  bool is_true() const { return right == 1 && down == 1; }
};

// For a page that leaves the printer turned by a quarter.
inline PrinterScale turned(const PrinterScale& scale) { return {scale.down, scale.right}; }

// Prints are accurate to some parts in a thousand; "fit to page" shrinks them by 3 to 6 percent.
inline constexpr double kMostPrinterScale = 0.02;

// Paper is moved and drawn by different parts of a printer, which differ by a few parts in a
// thousand; a misreading of one of two distances differs by more.
inline constexpr double kMostUnequalScale = 0.01;

// Whether both are within these, and are not those of a page fitted to a paper that is hardly
// smaller: which shrinks by more than 1 percent, both directions alike to 0.2 percent.
bool is_usual(const PrinterScale& scale);

// For messages: what is_usual expects.
std::string usual_scales();

// How much of a page's width and height a drawing of its true size covers: all, and where the
// printer shrinks pages as much as it leaves.
PrinterScale reach_of(const PrinterScale& scale);

struct PrinterProfile {
  std::string name;
  PrinterScale scale{};
  double growth_right = 0;  // metres that a bar is too wide, across and down the page
  double growth_down = 0;
  double dot_gain = 0;  // share of the area that a tone of one half covers beyond one half
};

// The correction for the growth, metres: a bar stands across or down the page, so the mean of both.
// Ink makes bars wider where they are printed, and narrower where they are the white between ink.
double bar_adjustment_for(const PrinterProfile& profile, bool white_on_black);

// ---- Tags whose edges fall between a printer's dots, and bars that grow when they are printed.

inline constexpr double kMetresPerInch = 0.0254;

// The template with a module of whole dots: the most dots that leave quiet zones of `quiet_zone`
// modules. The symbol stays in the middle of the frame, which keeps its size; the width that the
// symbol loses is added to its quiet zones and margins. A module that is whole to 1/100 dot stays
// unchanged, and so does the template when a module is narrower than one dot.
TagTemplate fitted_to_dots(TagTemplate tag, int dots_per_inch);

// The template as a printer of so many dots is to draw it. Cameras look for the bars where the
// template says, so its module becomes whole dots only where that moves no bar by more than a tenth
// of a module. Elsewhere the template stays: on_whole_dots then makes modules of two widths, one
// dot apart, that end within a dot of where they should.
TagTemplate drawn_on_dots(const TagTemplate& tag, int dots_per_inch);

// A module has fewer dots than this: rounding its edges would change its width by a fifth or more.
inline constexpr double kLeastDots = 5;

// The drawing, in the plate frame, with every edge of feature frame and bars at the nearest dot as
// counted from P. Quiet zones keep 9 modules where they had them: the outermost edges then go to
// the next dot inwards.
TagDrawing on_whole_dots(TagDrawing drawing, int dots_per_inch);

// What is added to the width of every bar, metres: the nearest whole number of dots where
// dots_per_inch is not 0.
double drawn_adjustment(double adjustment, int dots_per_inch);

// The drawing with `adjustment` metres (negative = less) added to the width of every bar and to the
// stroke of the feature frame, half on either side: it takes away what the ink adds. On whole dots
// (dots_per_inch not 0) it is the nearest whole number of them, an odd one to the right and below.
TagDrawing with_bar_adjustment(TagDrawing drawing, double adjustment, int dots_per_inch = 0);

// What drawing the template on dots changes, for people; empty when nothing. `drawn`: from
// drawn_on_dots.
std::string describe_rounding(const TagTemplate& wanted, const TagTemplate& drawn,
                              int dots_per_inch);

}  // namespace tagsmith::detail
