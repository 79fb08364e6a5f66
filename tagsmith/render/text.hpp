// SPDX-License-Identifier: Apache-2.0
// Lines of text set with the fonts of the machine: DejaVu Sans, and for characters it lacks
// whatever font has them. Safe to call from several threads at once.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tagsmith/tag/drawing.hpp"

typedef struct _cairo cairo_t;  // NOLINT(bugprone-reserved-identifier): as cairo.h has it

namespace tagsmith {

// True when the machine's fonts have every character of the text; what none has prints as a box.
bool has_glyphs(const std::string& text);

// Length of the text, set with capital letters of this height, metres; 0 without any font.
double text_width(const std::string& text, double height);

enum class PathVerb { move, line, curve, close };

// `points` holds one point for a move or a line, three for a Bezier curve, none for a close.
struct PathSegment {
  PathVerb verb = PathVerb::close;
  std::array<PlatePoint, 3> points{};
};

// Both set the item so that its ink keeps inside max_width, kTextAscent and kTextDescent: text too
// wide is shrunk to 60 %, what is still too wide then ends in an ellipsis. Without any font on the
// machine there is no text.

// Shows the text as glyphs in the context's current colour; the context's user space is the item's
// frame in metres.
void show_text(cairo_t* context, const TextItem& item);

// The glyphs' outlines in the item's frame.
std::vector<PathSegment> text_outline(const TextItem& item);

}  // namespace tagsmith
