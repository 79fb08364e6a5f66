// SPDX-License-Identifier: Apache-2.0
// A page drawn by Cairo. Internal to tagsmith/render.
#pragma once

#include "tagsmith/render/page.hpp"

typedef struct _cairo cairo_t;  // NOLINT(bugprone-reserved-identifier): as cairo.h has it

namespace tagsmith {

// Draws in black; the context's user space is the page frame. `with_contour`: cut contours go
// along, in the pure magenta that with_print_settings turns into the spot colour CutContour.
void draw_page(cairo_t* context, const Page& page, bool with_contour);

}  // namespace tagsmith
