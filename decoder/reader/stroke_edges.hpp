// SPDX-License-Identifier: Apache-2.0
// The outer edges of a frame's strokes: where something lies along an inner edge, as straight and
// as sharp as that, only the stroke's thickness shows it.
#pragma once

#include <array>
#include <optional>

#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"

namespace tagsmith::detail {

// By how much a side's stroke is thicker than the layout has it, besides the growth of everything
// black.
struct StrokeExcess {
  double px = 0;
  double sigma_px = 0;
};

// Of the frame's four sides, by the outer edges that are seen beside the inner ones; nothing of
// strokes of less than 4 pixels, which are fitted by both edges, and of sides whose outer edge does
// not show along most of their length.
using StrokeExcesses = std::array<std::optional<StrokeExcess>, 4>;
StrokeExcesses stroke_excesses(const GrayView& image, const SymbolHypothesis& symbol);

}  // namespace tagsmith::detail
