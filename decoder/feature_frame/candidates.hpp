// SPDX-License-Identifier: Apache-2.0
// Where feature frames may be.
#pragma once

#include <vector>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith {

// One level of an image pyramid.
struct PyramidLevel {
  GrayView image;
  double scale = 1;       // pixels of the full image per pixel of this level
  int min_contrast = 20;  // grey levels that stand out from this level's noise
};

// A quadrilateral of the level in pixels of the full image.
Quad to_full(const PyramidLevel& level, const Quad& quad);

// Quadrilaterals, in pixels of the level, that may be the inner edge of a feature frame: white
// regions, the insides of dark ones, and pairs of either that something in front has cut apart,
// where the outline fills its enclosing quadrilateral. Rough: to a pixel or two.
std::vector<Quad> find_candidates(const PyramidLevel& level);

}  // namespace tagsmith
