// SPDX-License-Identifier: Apache-2.0
// A sheet as PNG.
#pragma once

#include <string>

#include "tagsmith/base/result.hpp"
#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {

enum class PngColours { rgb, grey };  // grey: of 8 bits, for what has no colours

// The sheet at true scale on white, with its resolution (pHYs chunk) and title. Edges that lie on
// whole dots are sharp, others grey by coverage. Memory is used for one band of it at a time. The
// same sheet gives the same bytes. Fails when it would have more than 30 000 pixels a side.
Result<std::string> render_png(const Sheet& sheet, double dots_per_inch, PngColours colours);

}  // namespace tagsmith::detail
