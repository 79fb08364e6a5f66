// SPDX-License-Identifier: Apache-2.0
// From a rough quadrilateral to the edges of a feature frame, to about half a pixel.
#pragma once

#include <array>
#include <optional>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// A quick check: whether at half the places or more of every side (of those that are `looked_at`)
// the picture is white inside, dark on the stroke and white again beyond.
bool looks_framed(const GrayView& image, const Quad& rough, const FrameShape& shape = {},
                  const std::array<bool, 4>& looked_at = {true, true, true, true});

struct CoarseFrame {
  Quad corners{};
  SideSagittas bows{};
};

// Moves the sides of a rough quadrilateral onto the steepest falls from white inside to dark
// outside that most of a side's length agrees on. `bows`: how the lens bends the sides, if it is
// known, pixels of this image; where the falls do not agree with that, a side may bow more or less.
// Fails when a side shows no such edge.
FrameResult<CoarseFrame> fit_frame_coarsely(const GrayView& image, const Quad& rough,
                                            const SideSagittas& bows = {},
                                            const FrameShape& shape = {});

// A quadrilateral of which some sides may not be visible.
struct ShownSides {
  Quad quad{};
  std::array<bool, 4> shown{};  // side i runs from corner i to corner i + 1
};

// As fit_frame_coarsely, but sides that show no edge stay where they are, and none bows other than
// as `bows` says. Nothing when the sides do not close.
std::optional<ShownSides> settle_shown_sides(const GrayView& image, const Quad& rough,
                                             const SideSagittas& bows = {},
                                             const FrameShape& shape = {});

}  // namespace tagsmith::detail
