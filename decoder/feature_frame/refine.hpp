// SPDX-License-Identifier: Apache-2.0
// From the settled edges of a feature frame to its corners, to a small part of a pixel.
#pragma once

#include <array>
#include <cstddef>

#include "decoder/feature_frame/fitted_side.hpp"
#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

struct RefinedFrame {
  Quad corners{};  // of the inner edge, clockwise in the image
  std::array<FrameSide, 4> sides{};
  // Whether a side was fitted; otherwise it is known from elsewhere, and its levels are its
  // neighbours'.
  std::array<bool, 4> shown{true, true, true, true};
  LensDistortion lens;         // through which it was fitted
  double lens_doubt = 0;       // of an unknown lens: its lambda may be off by as much, 1 / pixels^2
  double unexplained_bow = 0;  // greatest clear bow of a side beyond its unknown lens, pixels
  bool was_sharpened = false;  // its picture, before that was undone
};

// The same frame with its corners and sides taken in cyclic order from corner `first` on.
RefinedFrame turned_to(RefinedFrame frame, std::size_t first);

// Fits each side of a settled inner edge with a blurred step from white inside to the black stroke
// and, where the stroke is thin, back to white, in light. Fails when one does not converge near
// where it was. Sides of a frame seen through a known lens bow as it says; through an unknown one,
// as a radial lens about the image's centre makes them, if they do so clearly, and each by its own
// remainder.
FrameResult<RefinedFrame> refine_frame(const GrayView& image, const Quad& settled,
                                       const LensGuess& lens = {}, const FrameShape& shape = {},
                                       bool was_sharpened = false);

// The same where something hides sides: those not `shown`, and those that cannot be fitted near
// where they are, stay there with `hidden_sigma` pixels of uncertainty at their ends. Fails when
// fewer than two sides are fitted or the sides do not close. A lens that is not given bends
// nothing; the bows that sides then show are added to the uncertainty of all.
FrameResult<RefinedFrame> refine_shown_sides(const GrayView& image, const Quad& settled,
                                             const std::array<bool, 4>& shown, double hidden_sigma,
                                             const LensDistortion& lens = {},
                                             const FrameShape& shape = {},
                                             bool was_sharpened = false);

}  // namespace tagsmith::detail
