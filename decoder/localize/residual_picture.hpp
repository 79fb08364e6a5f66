// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "decoder/localize/fix.hpp"
#include "tagsmith/survey/rig.hpp"

namespace tagsmith::detail {

// An SVG of a fix with an attitude: each camera's image as a frame with the tags' outlines, and an
// arrow at each corner from where the fit expects it to where it was seen, enlarged by the factor
// that the picture states. Tags that the fix does not use are grey.
std::string residual_picture(const Fix& fix, const Rig& rig);

}  // namespace tagsmith::detail
