// SPDX-License-Identifier: Apache-2.0
// How a camera sharpened a picture after taking it, determined from a feature frame's sides, and
// the picture without that. Why: docs/decisions/0006-lens-tone-and-shadows.md.
#pragma once

#include <optional>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// An unsharp mask.
struct Sharpening {
  double amount = 0;
  double sigma_px = 1.6;  // of the mask's Gaussian
  double black = 0;       // grey levels of the stroke and of the white inside, not yet sharpened
  double white = 255;
};

// What the visible sides of a fitted frame show of it; nothing where they show no halos.
std::optional<Sharpening> sharpening_of(const GrayView& image, const RefinedFrame& frame,
                                        const FrameShape& shape = {});

// Adds to the uncertainty of a frame's sides a share of the distance by which undoing the
// sharpening moved its corners: the mask is not known exactly. `before`: the corners in the stored
// picture.
void add_halo_doubt(const Quad& before, RefinedFrame& frame);

// A picture as it was before it was sharpened, near the places that were requested.
class UnsharpenedImage {
 public:
  explicit UnsharpenedImage(const GrayView& image);

  // Undoes the sharpening around a quadrilateral, as far as its feature frame and a margin reach.
  void undo(const Sharpening& sharpening, const Quad& quad);

  // Restores the picture there to what it was before anything was undone.
  void restore(const Quad& quad);

  GrayView view() const { return image_.view(); }

 private:
  GrayView sharp_;
  GrayImage image_;
};

}  // namespace tagsmith::detail
