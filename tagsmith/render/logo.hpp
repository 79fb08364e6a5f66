// SPDX-License-Identifier: Apache-2.0
// Logos on plates: the outlines of an SVG picture in one colour.
#pragma once

#include <filesystem>

#include "tagsmith/base/result.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {

// The outlines of everything darker than middle grey in the SVG file, on white ground, in a
// rectangle with its corner at the origin: as large as the rectangle allows, in its middle, and
// true to 1/4000 of its longer side. Plates are of one ink, so colours are not kept. Fails on a
// file of more than 2 MB, on one that is no SVG, and on a picture without anything dark.
Result<LogoDrawing> load_logo(const std::filesystem::path& file, double width, double height);

// The logo moved into the rectangle, which is as large as the one that it was loaded for.
LogoDrawing in_room(LogoDrawing logo, const Rectangle& room);

}  // namespace tagsmith::detail
