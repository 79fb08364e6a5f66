// SPDX-License-Identifier: Apache-2.0
// The scan profile of a symbol that something hides in part: the careful and slow way.
#pragma once

#include <cstddef>
#include <memory>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "decoder/reader/symbol_profile.hpp"

namespace tagsmith {

// What the light in front of a row adds within ten modules: the same everywhere, or, under a
// highlight, what changes from bar to bar.
enum class AddedLight { even, slanted };

// A symbol in a picture where profile_symbol is not enough. What is common to the rows of the bars
// is sought together with every row's own local white and contrast (about ten modules long), so
// that glare, shadows and thin dust only make a row count less; stretches of rows that do not
// follow the others, and cables across the tag (find_cover_strips), do not count at all. Places
// that no row shows get a variance that says nothing.
class CoveredSymbol {
 public:
  CoveredSymbol(const GrayView& image, const RefinedFrame& frame, std::size_t first_corner,
                const SymbolLayout& layout);
  CoveredSymbol(CoveredSymbol&&) noexcept;
  CoveredSymbol& operator=(CoveredSymbol&&) noexcept;
  ~CoveredSymbol();

  // Its scan profile under such light.
  SymbolProfile profile(AddedLight added);

 private:
  struct Seen;

  std::unique_ptr<Seen> seen_;  // its rows, cut out of the picture
};

// A frame's corners (from P on) with its sides turned so that every bar stands at the same place in
// all rows: what follows of one symbol from its upper and its lower rows, whatever lies between.
// `stroke_px` is the thickness of the frame's stroke, `lens` what it is seen through. The corners
// as they were where the rows do not tell.
Quad aligned_to_bars(const GrayView& image, const Quad& corners, double stroke_px,
                     const SymbolLayout& layout, const LensBend& lens = {});

}  // namespace tagsmith
