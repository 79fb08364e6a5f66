// SPDX-License-Identifier: Apache-2.0
// The tunnel from above with a mark on every tag, coloured and shaped by its status.
#pragma once

#include <string>
#include <vector>

#include "decoder/verify/verify_merge.hpp"
#include "tagsmith/render/sheet_layout.hpp"

namespace tagsmith::detail {

// Of the statuses of status_of.
Colour status_colour(const std::string& status);

// Adds the mark of that status: a disc, a diamond for `faulty`, a ring for `unseen`.
void add_status_mark(SketchLayer& layer, const SketchPoint& at, const std::string& status);

// A view for each strip of the tunnel; marks in the layer `status`.
std::vector<DrawingView> report_map(const Survey& survey, const VerifyMerge& merged);

}  // namespace tagsmith::detail
