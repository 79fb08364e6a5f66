// SPDX-License-Identifier: Apache-2.0
// What a feature frame holds, and whether it is believed.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/bar_regions.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/reader/symbol_layout.hpp"
#include "decoder/reader/symbol_profile.hpp"
#include "decoder/scan/decode.hpp"

namespace tagsmith {

// The symbol that explains best what stands in a frame; whether it is believed is another matter.
struct Attempt {
  Decoding decoding;
  std::size_t first_corner = 0;  // the frame's corner that is P
  SymbolProfile profile;
  SymbolLayout layout;
};

// The best explained symbol of the options' layouts, along the direction(s) in which it may run,
// from its quick profile (profile_symbol). Nothing where no guard patterns show.
std::optional<Attempt> attempt_quickly(const GrayView& image, const RefinedFrame& frame,
                                       const ReadOptions& options);

// The quick attempt or the careful one, whichever explains more.
std::optional<Attempt> attempt_both_ways(const GrayView& image, const RefinedFrame& frame,
                                         const ReadOptions& options);

// What speaks against believing a symbol that was read without regard to covers, in the words of
// Rejection::reason; nothing: it is believed.
std::optional<std::string> objection_to_quick(const GrayView& image, const RefinedFrame& frame,
                                              const Attempt& attempt, const ReadOptions& options);

// What a frame holds, where that is believed: read carefully, or, before that, quickly where its
// sides were found or completed by the bars since it was read last (`quickly_too`).
std::optional<Attempt> believed_attempt(const GrayView& image, const RefinedFrame& frame,
                                        const ReadOptions& options, bool quickly_too);

// Whether the quick profile shows so much of a symbol that a careful one may read it.
bool is_symbol_like(const Attempt& attempt);

// Why a symbol that no code of the book explains is none of them, where it is read for certain
// without the book.
std::optional<std::string> stranger_to_book(const GrayView& image, const RefinedFrame& frame,
                                            const ReadOptions& options);

// Where the bars put the frame's corners, from P on: along the symbol by its modules, across by the
// frame's own sides.
FrameCorners corners_by_bars(const RefinedFrame& frame, const Attempt& attempt);

// The frame's corners from P on. Whatever widens the bars, ink or a tone curve that is not sRGB,
// moves the frame's inner edge inwards by as much. Hidden sides are where the bars put them.
FrameCorners corners_of(const RefinedFrame& frame, const Attempt& attempt);

// What is told of an attempt that is believed; `method` says which way it was read.
Reading reading_from(const RefinedFrame& frame, const Attempt& attempt, const char* method);

// Width of a module of a symbol along the frame's longer sides, pixels; roughly.
double module_across(const Quad& frame);

// Where the bars are in a frame of which a side may be something else's edge.
BarRegion bars_inside(const GrayView& image, const Quad& quad);

}  // namespace tagsmith
