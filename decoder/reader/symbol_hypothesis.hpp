// SPDX-License-Identifier: Apache-2.0
// What may stand in a feature frame, with everything that was measured of it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/robust_profile.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "decoder/scan/decoding.hpp"

namespace tagsmith::detail {

// The symbol that explains best what stands in a frame; whether it is believed is another matter.
struct SymbolHypothesis {
  RefinedFrame frame;  // from P on
  SymbolLayout layout;
  SymbolProfile profile;  // along the symbol, from its end on where decoding.upside_down says so
  Decoding decoding;
  bool in_shadow = false;  // shadows, or a lamp's spot, are known to lie on the plate
  // What it was read from, while it is judged; it refers to the image.
  std::shared_ptr<const RobustProfile> rows{};
};

// The rows of a frame by which a symbol is judged: those that it was read from, if they begin at
// the frame's first corner; else they are cut out of the image.
std::shared_ptr<const RobustProfile> rows_of(const GrayView& image, const RefinedFrame& frame,
                                             const SymbolHypothesis& symbol);

// Whether a symbol is beyond doubt by its whole height: then its halves need no check.
bool is_beyond_doubt(const Decoding& decoding);

// The best explained symbol of the options' layouts, along the direction(s) in which it may run,
// from the rows that agree (RobustProfile::of_agreeing_rows). Nothing where no guard patterns are
// visible. Where shadows lie on the plate, both as seen and evened out; as seen alone, where that
// leaves no doubt.
std::optional<SymbolHypothesis> quick_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                 const ReadOptions& options);

// The same from all rows, with what each shows by its own light (RobustProfile::of_all_rows).
std::optional<SymbolHypothesis> careful_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                   const ReadOptions& options, AddedLight added);

// By the rows that agree or by all of them, whichever explains more.
std::optional<SymbolHypothesis> better_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                  const ReadOptions& options);

// By how many pixels everything black is broader than it was drawn. `along_bars_px`: by how many
// more the frame's upper and lower strokes are, if it is the print that grew: seen obliquely, a
// length on the plate is longer along the bars than across them; a tone curve's growth is the same
// in all directions of the image.
struct BlackGrowth {
  double px = 0;
  double doubt_px = 0;
  double along_bars_px = 0;
};

// By the bars; where the picture was sharpened, by the frame's stroke.
BlackGrowth growth_of(const SymbolHypothesis& symbol);

// The frame's corners. Whatever widens the bars, ink or a tone curve that is not sRGB,
// moves the frame's inner edge inwards by as much. Hidden sides are where the bars put them.
FrameCorners corners_of(const SymbolHypothesis& symbol);

// Where the bars put the frame's corners: along the symbol by its modules, across by the
// frame's own sides.
FrameCorners corners_by_bars(const SymbolHypothesis& symbol);

// The corners of a frame that may be P's: the symbol runs in the direction in which the grey level
// changes; both directions when that is not clear. Upside down is decided by the symbol.
std::vector<std::size_t> possible_first_corners(const GrayView& image, const Quad& quad);

}  // namespace tagsmith::detail
