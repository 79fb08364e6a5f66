// SPDX-License-Identifier: Apache-2.0
// The one geometry of a tag that printing, simulation, tests and the decoder share.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// Plate frame: origin at P (upper left inner corner of the feature frame), x to the right, y down,
// metres, seen facing the plate.
struct Rectangle {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

// A point of the plate frame.
struct PlatePoint {
  double x = 0;
  double y = 0;
};

// Clockwise from the upper left one.
std::array<PlatePoint, 4> corners_of(const Rectangle& rectangle);

// How far the ink of a line of text may reach above and below its baseline, in heights of a capital
// letter: space for accents, descenders and full-width characters. The code that sets the text
// shrinks it to stay inside.
inline constexpr double kTextAscent = 1.3;
inline constexpr double kTextDescent = 0.4;

// A text too long for its width is shrunk to this at most, and then cut.
inline constexpr double kLeastTextShrink = 0.6;

// A line of text; (x, y) is the left end (centred: the middle) of its baseline.
struct TextItem {
  std::string text;
  double x = 0;
  double y = 0;
  double height = 0;     // of a capital letter
  double max_width = 0;  // the text is shrunk to fit
  bool centred = false;
  bool upwards = false;  // turned to read from below upwards
};

// An arrow that must point up when the plate hangs; the box around it.
struct UpArrow {
  Rectangle box;
};

// The arrow's corners, clockwise from its tip.
std::array<PlatePoint, 7> outline_of(const UpArrow& arrow);

// The circle that is drilled out.
struct HoleOutline {
  PlatePoint centre;
  double radius = 0;
};

// True when the hole and the rectangle have a point in common.
bool touches(const HoleOutline& hole, const Rectangle& box);

// White and black of this print, for judging photos of it: two squares side by side.
struct ReferencePatches {
  Rectangle white;  // as the plate; outlined with a thin line
  Rectangle black;
};

// A QR symbol on white ground of its own, on plates that are white on black too.
struct QrDrawing {
  Rectangle box;                     // white: the symbol with its quiet zone
  std::vector<Rectangle> modules{};  // black; filled in when printed (render/qr_symbol.hpp)
};

// Space for a logo, and the area inside an odd number of outlines; black. Filled in when printed
// (render/logo.hpp).
struct LogoDrawing {
  Rectangle room;
  std::vector<std::vector<PlatePoint>> outlines{};
};

// Black here is white on a plate that is white on black, and the reverse.
struct TagDrawing {
  Rectangle plate;              // white
  Rectangle frame_outer;        // black between the outer and the inner rectangle
  Rectangle frame_inner;        // white inside
  std::vector<Rectangle> bars;  // black, left to right: the 30 bars of the symbol
  std::vector<TextItem> label;  // black
  std::vector<UpArrow> arrows;  // black
  double module = 0;            // module width
  std::optional<ReferencePatches> patches{};
  std::optional<QrDrawing> qr{};
  std::optional<LogoDrawing> logo{};
  std::vector<HoleOutline> holes{};
  double corner_radius = 0;  // of the plate
  bool white_on_black = false;
  bool cut_contour = false;  // plate and holes are outlined for a cutting plotter
};

// The drawing with everything moved, and its lengths multiplied first: x' = scale x + right.
TagDrawing moved(TagDrawing drawing, double right, double down, double scale = 1);

// The text of the label, the most important line first. Lines that don't fit below each other are
// joined on one.
struct TagText {
  std::vector<std::string> lines;
};

// White that the label leaves around the feature frame: a stroke, at most 12 mm; metres.
double label_clearance(const TagTemplate& tag);

// White that ink keeps from the plate's edge, metres: a cut is never exact.
inline constexpr double kEdgeClearance = 0.003;

// The strip below the feature frame that label, logo, QR symbol and reference patches share; its
// height is negative where there is none.
Rectangle strip_below_frame(const TagTemplate& tag);

// The label stands below the feature frame, label_clearance from it and 3 mm clear of the plate's
// edge; where that strip is too thin to be read, left of the frame, reading upwards; where neither
// has room for kLeastLabelHeight, it is left out. Reference patches stand at the right end of the
// strip below the frame, left of them the QR symbol and then the logo; each is left out where it is
// higher than the strip or takes more than half of what is left of it.
TagDrawing draw_tag(const TagTemplate& tag, const Digits& digits, const TagText& text = {});

// Capital letters smaller than this cannot be read on a wall at arm's length.
inline constexpr double kLeastLabelHeight = 0.001;

}  // namespace tagsmith::detail
