// SPDX-License-Identifier: Apache-2.0
// A page with plates as a sheet, to be written as PDF, SVG or PNG.
#pragma once

#include "tagsmith/render/page.hpp"
#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {

// All in black. Feature frame, bars, arrow, patches, drill holes and label are separate layers,
// named `tag-1-bars` and so on where the page has several tags or shows one in part, and titled
// with the tag's name. `with_contour`: outlines and holes of plates that are to be cut are in the
// layer CutContour; without it holes are circles for drilling.
Sheet sheet_of(const Page& page, bool with_contour = true);

// The inside of a rectangle of the page.
SheetArea area_of(const Rectangle& rectangle, const Colour& fill = colours::kBlack);

// The sheet's content larger or smaller about the upper left corner of the paper, which keeps its
// size, as do letters and line widths.
Sheet scaled(Sheet sheet, double right, double down);

}  // namespace tagsmith::detail
