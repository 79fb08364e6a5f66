// SPDX-License-Identifier: Apache-2.0
// The reader sees a feature frame's sides as straight lines, which a distorting lens bends.
#pragma once

#include "decoder/reader/reading.hpp"
#include "tagsmith/geometry/camera.hpp"

namespace tagsmith {

// The corners themselves, given where straight lines fitted to the whole of each bent side meet
// (least squares, every pixel along the side with one weight, as the reader fits them). As given
// under a lens without distortion, and where the lens model has no ray.
//
// A fitted line stands off a bent side's ends by two thirds of its bulge: without this a corner of
// a tag that fills a third of a fisheye's image is off by a pixel.
FrameCorners corners_of_bent_sides(const Camera& camera, const FrameCorners& line_corners);

}  // namespace tagsmith
