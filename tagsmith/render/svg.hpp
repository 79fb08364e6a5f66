// SPDX-License-Identifier: Apache-2.0
// A sheet as SVG.
#pragma once

#include <string>

#include "tagsmith/render/sheet.hpp"

namespace tagsmith::detail {

// An SVG 1.1 document whose user unit is one millimetre, with the sheet's size in mm on white. Each
// layer is a separate group (`id` = its name). Text is outlines with the words as their title: it
// looks the same where fonts are missing. The same sheet gives the same bytes.
std::string render_svg(const Sheet& sheet);

}  // namespace tagsmith::detail
