// SPDX-License-Identifier: Apache-2.0
// Where a frame's corners are by all that was seen of a tag.
#pragma once

#include <array>

#include "decoder/feature_frame/corner_covariance.hpp"
#include "decoder/feature_frame/frame.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/bar_ends.hpp"
#include "decoder/reader/robust_profile.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"
#include "decoder/scan/symbol_fit.hpp"

namespace tagsmith::detail {

struct PlacedCorners {
  FrameCorners corners{};
  CornerCovariance covariance;  // pixels^2
};

// How the bars of each quarter of their height are displaced, from the upper end on.
using SeenBands = std::array<SeenPlaces, 4>;
HeightShare band_of(int band);

// What is unsure about the corners, pixels^2, where the camera or the vehicle moved while the image
// was taken. A camera that shakes while it reads its rows one after another: the bars of several
// heights lie on no straight line at their middle (a module), and the upper and the lower corners
// are unsure along the bars, independently of each other. An interlaced one: each corner may belong
// to either field. Two exposures in one image, or a filter that mixes earlier ones into it: all
// corners may be displaced alike. Zero where noise explains it.
CornerCovariance covariance_by_motion(const GrayView& image, const SeenBands& bands, double middle,
                                      const SymbolHypothesis& symbol);

// Where a symbol's bars end, in its frame as that was fitted.
BothEnds bar_ends_of(const GrayView& image, const SymbolHypothesis& symbol);

// Of the corners as the frame's sides give them, pixels^2, with what growth and strokes make
// unsure about all of them.
CornerCovariance covariance_by_frame(const GrayView& image, const SymbolHypothesis& symbol);

// From the frame's sides, from the bars of the upper and of the lower half of their height, which
// give the sides that run beside them (59 edges, of which one half is moved by growth and blur in
// the opposite direction to the other half), and from where the bars end (`bar_ends_of`).
// Differences between these beyond the expected are added to the covariance; where they contradict
// the frame, its corners stay. A side whose stroke differs from the others (stroke_edges.hpp) is
// unsure, and so are corners where rows of the image are displaced relative to each other. Why:
// docs/decisions/0007-corner-covariance.md.
PlacedCorners placed_by_frame_and_bars(const GrayView& image, const SymbolHypothesis& symbol,
                                       const BothEnds& ends);

}  // namespace tagsmith::detail
