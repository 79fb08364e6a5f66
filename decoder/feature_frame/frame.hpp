// SPDX-License-Identifier: Apache-2.0
// The feature frame: its corners in a picture, its proportions, and why an outline is no frame.
#pragma once

#include <tl/expected.hpp>

#include "decoder/feature_frame/quad.hpp"

namespace tagsmith::detail {

// Inner corners of the feature frame, clockwise from P: P, F, lower right, Q, as the tag's own
// "up" says (whatever way it is turned in the image).
using FrameCorners = Quad;

// The proportions of a feature frame as it is printed: of its inner edge and of its stroke, in
// modules of the symbol inside. The search needs to know them roughly. The default is that of the
// larger plate of Xu et al. (2017).
struct FrameShape {
  double length = 113;          // along the symbol
  double height = 55.3;         // along its bars
  double stroke = 3.95;         // thickness
  double stroke_tolerance = 1;  // by what share of it all strokes of a print may differ from it

  bool operator==(const FrameShape&) const = default;
};

// Why an outline could not be fitted as the inner edge of a feature frame.
enum class FrameFault {
  not_framed,      // no white, black, white across its sides
  no_edge,         // a side shows no edge along most of its length
  side_too_short,  // a side has too few pixels
  no_fit,          // a side's edge cannot be fitted near where it was
  not_closed,      // the sides do not meet in four corners
  covered,         // fewer than two sides are visible
  crossed,         // its sides are lines that cross, as wires do
};

template <class T>
using FrameResult = tl::expected<T, FrameFault>;

inline tl::unexpected<FrameFault> fail(FrameFault fault) { return tl::unexpected(fault); }

}  // namespace tagsmith::detail
