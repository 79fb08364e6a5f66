// SPDX-License-Identifier: Apache-2.0
// A survey in the formats of CAD, and of surveyors' instruments and offices.
#pragma once

#include <string>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// DXF of AutoCAD 2000 (AC1015) in grid coordinates, metres ($INSUNITS 6), to the micrometre.
// Layers: CENTERLINE and WALLS on the floor (level arcs as ARC, graded ones as 3D lines), PLATES
// (outline of each plate in space), FRAMES (inner outline of the feature frame), P (points), HOLES
// (points in the middle of each drill hole) and NAMES (texts "000L  digits" at P, 100 mm high). A
// grid with x to the left keeps its numbers: in CAD, where x always grows to the right, the plan is
// then the mirror image, as all drawings in that grid are.
std::string render_dxf(const Survey& survey);

// LandXML 1.2, metres: the center line as an alignment with its profile, and P of each tag as a
// CgPoint whose code is the tag's name and whose description its digits; template, code and
// handedness in a Feature of the points. `tagsmith new --from` reads it back. In the grid; a grid
// with x to the left is drawn as a mirror image.
std::string render_landxml(const Survey& survey);

// Leica GSI-16, metres to a tenth of a millimetre: a block a tag with its name (words 11 and 71),
// P (81, 82, 83) and digits (72), behind blocks of codes (41) with template, code and handedness.
// `tagsmith new --from` reads it back.
std::string render_gsi(const Survey& survey);

}  // namespace tagsmith::detail
