// SPDX-License-Identifier: Apache-2.0
// A survey as a CAD drawing.
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

}  // namespace tagsmith::detail
