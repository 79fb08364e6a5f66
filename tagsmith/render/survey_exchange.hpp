// SPDX-License-Identifier: Apache-2.0
// A survey in formats of surveyors' instruments and offices.
#pragma once

#include <string>

#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail {

// LandXML 1.2, metres: the center line as an alignment with its profile, and P of each tag as a
// CgPoint whose code is the tag's name and whose description its digits. `tagsmith new --from`
// reads it back. In the grid; a grid with x to the left is drawn as a mirror image.
std::string render_landxml(const Survey& survey);

// Leica GSI-16, metres to a tenth of a millimetre: a block a tag with its name (words 11 and 71),
// P (81, 82, 83) and digits (72). `tagsmith new --from` reads it back.
std::string render_gsi(const Survey& survey);

}  // namespace tagsmith::detail
