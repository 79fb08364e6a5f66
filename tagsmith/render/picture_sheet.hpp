// SPDX-License-Identifier: Apache-2.0
// A sketch by itself, for pages that show it as a picture.
#pragma once

#include <string>

#include "tagsmith/render/sheet.hpp"
#include "tagsmith/render/sketch.hpp"

namespace tagsmith::detail {

// A sheet as large as the sketch's ink with a margin of 2 mm; one metre of the ground is one of
// paper.
Sheet picture_sheet(const Sketch& sketch, const std::string& title);

}  // namespace tagsmith::detail
