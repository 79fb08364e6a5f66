// SPDX-License-Identifier: Apache-2.0
// A tag on its page: the plate at true scale, and around it what a sign maker cuts and measures by.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/tag/drawing.hpp"

namespace tagsmith {

struct PageStyle {
  double margin = 0.025;  // around the plate, metres; at least kLeastPageMargin
};

// What the margin has to hold: crop marks, scale bars and notes.
inline constexpr double kLeastPageMargin = 0.022;

// Nominal length of the scale bars, metres.
inline constexpr double kScaleBarLength = 0.1;

// What is said about a page, in the margin and in the file's metadata.
struct PageNotes {
  std::string title;    // the survey and the tag
  std::string subject;  // what is on the page
};

// A straight line with flat ends.
struct PageLine {
  PlatePoint from;
  PlatePoint to;
};

// Page frame: origin at the page's upper left corner, x to the right, y down, metres.
struct Page {
  double width = 0;
  double height = 0;
  double line_width = 0.0002;
  PageNotes notes;
  TagDrawing tag;               // moved to its place on the page
  std::vector<PageLine> lines;  // crop marks and scale bars, outside the plate
  std::vector<TextItem> texts;  // outside the plate
};

// The page is the plate plus the margin on every side, larger where a plate is shorter than a scale
// bar. Crop marks stand outside the plate at its corners; a horizontal scale bar in the lower
// margin, a vertical one in the left margin, the notes in the upper margin.
Page lay_out_page(const TagDrawing& tag, const PageNotes& notes, const PageStyle& style = {});

}  // namespace tagsmith
