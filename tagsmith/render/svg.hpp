// SPDX-License-Identifier: Apache-2.0
// A page as SVG.
#pragma once

#include <string>

#include "tagsmith/render/page.hpp"

namespace tagsmith {

// An SVG 1.1 document whose user unit is one millimetre, with the page's size in mm. Everything is
// a path or a line in pure black on a white page, text as outlines: it opens alike where fonts are
// missing. Feature frame, bars, label and marks are groups of their own (`id`); the cut contour is
// a magenta one named CutContour. On pages of several tags each is a group with its name as title.
// The same page gives the same bytes.
std::string render_svg(const Page& page);

}  // namespace tagsmith
