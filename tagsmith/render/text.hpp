// SPDX-License-Identifier: Apache-2.0
// Lines of text set with the fonts of the machine: DejaVu Sans, and for characters it lacks
// whatever font has them. Safe to call from several threads at once.
#pragma once

#include <string>
#include <vector>

#include "tagsmith/render/sheet.hpp"

typedef struct _cairo cairo_t;  // NOLINT(bugprone-reserved-identifier): as cairo.h has it

namespace tagsmith::detail {

// True when the text is too long for its width even when it is shrunk, and so ends in an ellipsis.
bool is_cut(const SheetText& text);

// True when the machine's fonts have every character of the text; what none has prints as a box.
bool has_glyphs(const std::string& text);

// Length of the text, set with capital letters of this height, metres; 0 without any font.
double text_width(const std::string& text, double height);

// The text in lines that are no longer, broken at its spaces; a longer word stays whole.
std::vector<std::string> lines_of(const std::string& text, double width, double height);

// Both set the text so that its ink stays inside max_width, kTextAscent and kTextDescent: text that
// is too wide is shrunk to 60 %; text that is still too wide then ends in an ellipsis. Without any
// font on the machine there is no text.

// Shows the text as glyphs; the context's user space is the sheet's frame.
void show_text(cairo_t* context, const SheetText& text, bool as_outlines = false);

// The glyphs' outlines as path data of SVG, millimetres from the text's place along its baseline.
std::string text_path(const SheetText& text);

}  // namespace tagsmith::detail
