// SPDX-License-Identifier: Apache-2.0
// The file for a cutting plotter.
#pragma once

#include <string>

#include "tagsmith/render/page.hpp"

namespace tagsmith::detail {

// DXF of AutoCAD R12 (AC1009) with the outlines of all plates on the page, round corners as arcs,
// and their holes, in layer CutContour: millimetres from the page's lower left corner, y up.
std::string render_cut_file(const Page& page);

}  // namespace tagsmith::detail
