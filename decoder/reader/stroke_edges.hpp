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
// black and what all strokes have in common.
struct StrokeExcess {
  double px = 0;
  double sigma_px = 0;
  // What it has in common with the others, where the layout's stroke is known: they were printed
  // so, or what the camera does to a picture moves edges that stand alone otherwise than bars.
  double common_px = 0;
};

// Of the frame's four sides, by the outer edges that are seen beside the inner ones; nothing of
// strokes of less than 4 pixels, which are fitted by both edges, and of sides whose outer edge does
// not show along most of their length.
using StrokeExcesses = std::array<std::optional<StrokeExcess>, 4>;
StrokeExcesses stroke_excesses(const GrayView& image, const SymbolHypothesis& symbol);

}  // namespace tagsmith::detail
