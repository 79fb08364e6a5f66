// SPDX-License-Identifier: Apache-2.0
// A printed page: plates at true scale, with marks around them for cutting, aligning and measuring.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// The text about a page, in its margin and in the file's metadata.
struct PageNotes {
  std::string title;                // the survey and the tag
  std::string subject;              // what is on the page
  std::string keywords{};           // of the file: survey and revision
  std::vector<std::string> more{};  // further lines for the margin: material, rounding
};

// A straight line with flat ends.
struct PageLine {
  PlatePoint from;
  PlatePoint to;
  bool dashed = false;
};

// A tag on a page, wholly or in part.
struct PageTag {
  std::string name;
  TagDrawing drawing;                 // at its place on the page
  std::optional<Rectangle> window{};  // the part that is shown; none = all
  bool at_true_scale = true;
  // The drawing stands a quarter turn counter-clockwise about this point; none = as it is.
  std::optional<PlatePoint> turned_about{};
};

// Where a point or a rectangle of the tag's drawing stands on the page, its turn included.
PlatePoint on_page(const PageTag& tag, const PlatePoint& point);
Rectangle on_page(const PageTag& tag, const Rectangle& rectangle);

// Page frame: origin at the page's upper left corner, x to the right, y down, metres.
struct Page {
  std::string name{};  // of this page among those of its file ("A1"); may be empty
  double width = 0;
  double height = 0;
  double line_width = 0.0002;
  PageNotes notes{};
  std::vector<PageTag> tags{};
  std::vector<PageLine> lines{};  // marks and scale bars
  std::vector<TextItem> texts{};
  std::optional<Rectangle> trim{};   // the part cut out: the plate, where it is the page's only one
  std::optional<Rectangle> bleed{};  // to where the plate's surface is printed
};

struct PageStyle {
  double margin = 0.025;  // around the plate, metres; at least least_margin(bleed)
  double bleed = 0.003;   // of the plate's surface beyond its edge
  int dots_per_inch = 0;  // P stands on a whole dot of this printer; 0 = anywhere
};

// The margin must hold: bleed, crop marks, scale bars and notes.
double least_margin(double bleed);

// Nominal length of the scale bars, metres.
inline constexpr double kScaleBarLength = 0.1;

// Of scale bars from the page's edge, metres: printers leave about 5 mm blank.
inline constexpr double kScaleBarInset = 0.008;

// Height of a capital letter in notes, metres.
inline constexpr double kNoteHeight = 0.0025;

// The page is the plate plus the margin on every side, larger where a plate is shorter than a scale
// bar. Crop marks stand outside the bleed at the plate's corners; a horizontal scale bar in the
// lower margin, a vertical one in the left margin, the notes in the upper margin.
Page lay_out_page(const std::string& name, const TagDrawing& tag, const PageNotes& notes,
                  const PageStyle& style = {});

// Marks of `length` outside the rectangle's corners, in line with its edges, `gap` away from them.
void add_crop_marks(Page& page, const Rectangle& plate, double gap, double length);

// Scale bars with their nominal lengths: the horizontal one in the middle of the page along `y`,
// the vertical one in the middle along `x`.
void add_scale_bars(Page& page, double x, double y);

// A line of text in the middle of the page.
void add_note(Page& page, const std::string& text, double baseline, double max_width);

// "feature frame inside 343 x 168 mm ...": what to check with a tape.
std::string what_to_measure(const TagDrawing& tag);

// The nearest begin of a dot at or before the value; `value` itself for 0 dots per inch.
double at_dot(double value, int dots_per_inch);

}  // namespace tagsmith::detail
