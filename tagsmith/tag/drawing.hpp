// SPDX-License-Identifier: Apache-2.0
// The one geometry of a tag that printing, simulation, tests and the decoder share.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith {

// Plate frame: origin at P (upper left inner corner of the feature frame), x to the right, y down,
// metres, seen facing the plate.
struct Rectangle {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

// A line of text; (x, y) is the left (or centre) end of its baseline.
struct TextItem {
  std::string text;
  double x = 0;
  double y = 0;
  double height = 0;     // of a capital letter
  double max_width = 0;  // the text is shrunk to fit
  bool centred = false;
};

// An arrow that must point up when the plate hangs; the box around it.
struct UpArrow {
  Rectangle box;
};

struct TagDrawing {
  Rectangle plate;               // white
  Rectangle frame_outer;         // black between the outer and the inner rectangle
  Rectangle frame_inner;         // white inside
  std::vector<Rectangle> bars;   // black, left to right: the 30 bars of the symbol
  std::vector<TextItem> label;   // black
  std::vector<UpArrow> arrows;   // black
  double module = 0;             // module width
};

// What the label says, line by line; each line is set on its own line when it fits the plate.
struct TagText {
  std::vector<std::string> lines;
};

TagDrawing draw_tag(const TagTemplate& tag, const Digits& digits, const TagText& text = {});

}  // namespace tagsmith
