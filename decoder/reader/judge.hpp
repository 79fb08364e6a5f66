// SPDX-License-Identifier: Apache-2.0
// Whether what stands in a frame is believed.
#pragma once

#include <optional>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"

namespace tagsmith::detail {

// The reason for not believing a symbol: the first test that failed, and by how much.
struct Objection {
  RejectionReason reason = RejectionReason::doubtful;
  double measured = 0;
  double limit = 0;
};

// The same by what was decoded alone; nothing if all its tests are passed.
std::optional<Objection> objection_to(const Decoding& decoding, const ReadOptions& options);

// Whether the upper or the lower half of the bars' height shows another symbol clearly: something
// covers part of the height, and the rest may show something that is no digit. `rows` run as they
// were decoded.
// Why: docs/decisions/0004-covered-tags.md.
bool halves_contradict(const RobustProfile& rows, const Decoding& decoding);

// The reason for not believing a symbol that was read without regard to covers; nothing if it is
// believed.
std::optional<Objection> objection_to_quick(const GrayView& image, const SymbolHypothesis& symbol,
                                            const ReadOptions& options);

// What a frame holds, where that is believed: read carefully, or, before that, quickly where its
// sides were found or completed by the bars since it was last read (`quickly_too`).
std::optional<SymbolHypothesis> believed_hypothesis(const GrayView& image,
                                                    const RefinedFrame& frame,
                                                    const ReadOptions& options, bool quickly_too);

// Whether the quick profile shows enough of a symbol for a careful one to read it.
bool is_symbol_like(const SymbolHypothesis& symbol);

// Whether what is inside a frame may be a symbol that cannot be read: it is symbol-like, or its
// bars are as dark as the frame and it explains half of the profile or has guard patterns, and
// growth and blur leave enough of its bars for that to count. If not, the frame is no tag's: joints
// of bricks, a grating on a plate, a cell of wire mesh.
bool may_be_symbol(const SymbolHypothesis& symbol);

// Whether bars are wide enough to be seen, none of one module vanished by growth, and all are about
// as sharp and as black as the strokes beside them, to a factor of e, as those of one plate are.
bool suits_its_frame(const SymbolHypothesis& symbol);

// The symbol that is certain without the code book but is none of its codes, where there is a code
// book.
std::optional<SymbolHypothesis> stranger_to_book(const GrayView& image, const RefinedFrame& frame,
                                                 const ReadOptions& options);

// The reading of a believed symbol whose bars end where its frame has them end, or, where one of
// the frame's upper and lower sides is something else's edge, with that side where the bars put it.
// Nothing where the bars end elsewhere.
std::optional<Reading> reading_where_bars_end(const GrayView& image, const SymbolHypothesis& symbol,
                                              const ReadOptions& options, ReadingMethod method);

// The rejection that reports a symbol which is not believed.
Rejection rejection_of(SymbolHypothesis symbol, const Objection& objection);

}  // namespace tagsmith::detail
