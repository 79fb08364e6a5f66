// SPDX-License-Identifier: Apache-2.0
// Feature frames that the picture's border cuts: three sides are in sight, the fourth is beyond.
#pragma once

#include <cstddef>
#include <optional>

#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/image/gray.hpp"
#include "tagsmith/geometry/camera.hpp"

namespace tagsmith::detail {

// The same quadrilateral with its corners taken in cyclic order from this one on.
Quad beginning_at(const Quad& quad, std::size_t corner);

// An outline of a level of which exactly one side lies on the picture's border, turned so that this
// is side 1; nothing for another outline.
std::optional<Quad> cut_by_border(const PyramidLevel& level, const Quad& quad);

// The part of a picture in front of an object that hides side 1 of an outline: the rows or columns
// up to the object, and the outline where they end, both as if the picture's border cut the tag
// there.
struct PictureBeside {
  GrayView view;
  PixelPoint first;  // the view's first pixel in the picture
  Quad quad;         // in pixels of the view
};

// Nothing where no row or column before the object crosses both sides of the outline.
std::optional<PictureBeside> picture_beside(const GrayView& image, const Quad& outline);

// The whole frame, of such a shape, of which a cut outline (pixels of the picture, side 1 on the
// border) shows the sides 0, 2 and 3, as a camera sees it: corners 1 and 2 are placed so that the
// sides are those of a rectangle of these proportions. Nothing where no rectangle looks like this.
std::optional<Quad> completed_by_shape(const Quad& cut, const FrameShape& shape,
                                       const Camera& camera);

// Fits the sides 0, 2 and 3 of a frame whose side 1 is out of the picture; side 1 stays. Nothing
// where one of the three is not visible.
std::optional<RefinedFrame> fit_cut_frame(const GrayView& image, const Quad& corners,
                                          const FrameShape& shape, const LensDistortion& lens,
                                          bool was_sharpened = false);

// Whether the picture shows a place.
bool is_in_picture(const GrayView& image, PixelPoint at);

}  // namespace tagsmith::detail
