// SPDX-License-Identifier: Apache-2.0
// The one geometry of a tag that printing, simulation and reading share, metres.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tagsmith/export.hpp>

namespace tagsmith {

// A plate's dimensions, metres, as seen by a viewer who faces it. The defaults are the plate of the
// straight corridor of Xu et al. (2017).
struct PlateTemplate {
  std::string name = "tag-400x300";
  double plate_length = 0.400;
  double plate_height = 0.300;
  double frame_inner_length = 0.343;  // inside the feature frame
  double frame_inner_height = 0.168;
  double frame_stroke = 0.012;    // thickness of the feature frame
  double frame_offset_right = 0;  // of the frame's centre from the plate's
  double frame_offset_up = 0;
  double quiet_zone_modules = 9;  // white inside the frame left and right of the bars
  double margin_modules = 9;      // and above and below them
  bool white_on_black = false;    // frame and bars are white, the plate is black
};

// Plate frame: origin at P, the upper left inner corner of the feature frame, x to the right, y
// down, metres.
struct Rectangle {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

// The printed parts, without words and arrow. On a plate that is white on black, black and white
// are exchanged.
struct TagDrawing {
  Rectangle plate;              // white
  Rectangle frame_outer;        // black between this and the inner rectangle
  Rectangle frame_inner;        // white
  std::vector<Rectangle> bars;  // black, left to right: the 30 bars of the symbol
  double module = 0;            // width of the narrowest bar
};

// Fails with ErrorCode::invalid_argument when `digits` are not twelve, and when the plate's
// dimensions leave no space for the bars or for the frame.
TAGSMITH_EXPORT TagDrawing draw_tag(const PlateTemplate& plate, std::string_view digits);

}  // namespace tagsmith
