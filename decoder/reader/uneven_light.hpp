// SPDX-License-Identifier: Apache-2.0
// Shadows on a plate: the light on its bars is determined from its white.
// Why: docs/decisions/0006-lens-tone-and-shadows.md.
#pragma once

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_rows.hpp"

namespace tagsmith::detail {

// Whether the white above and below the bars is lit much more in one place than in another.
bool is_unevenly_lit(const GrayView& image, const RefinedFrame& frame, const SymbolLayout& layout);

// Changes the light of the rows to what it would be if all of the plate were lit as its bright
// parts are, and returns that of the white there. What lies in the dark does not count any more,
// what lies beside the edge of a shadow less. `blur`: standard deviation of the point spread,
// modules.
double even_out(SymbolRows& rows, double blur);

}  // namespace tagsmith::detail
