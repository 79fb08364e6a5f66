// SPDX-License-Identifier: Apache-2.0
// Pieces that every SVG of the program is made of. Its user unit is one millimetre.
#pragma once

#include <string>

#include "tagsmith/tag/drawing.hpp"

namespace tagsmith {

// Metres as millimetres, to the nanometre.
std::string svg_mm(double metres);

// The text's glyphs as path data, in the item's frame.
std::string svg_outline(const TextItem& item);

}  // namespace tagsmith
