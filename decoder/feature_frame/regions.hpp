// SPDX-License-Identifier: Apache-2.0
// White and dark regions of an image: local threshold, runs, connected regions.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/tile_threshold.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

struct RegionOptions {
  // A neighbourhood whose contrast is less than this many grey levels is flat, and white.
  int min_contrast = 20;
  // Regions smaller than this, in pixels across and down, cannot hold a readable symbol.
  int min_width = 20;
  int min_height = 12;
  // Regions larger than this, in pixels across or down, are left out.
  int max_size = std::numeric_limits<int>::max();
  // About so many changes of colour along the rows are followed, those of the greatest contrast: a
  // bound on the time for images full of texture or noise.
  std::size_t max_changes = std::numeric_limits<std::size_t>::max();
  // The tiles that are searched, the others are taken for flat; null = all.
  const TileMask* searched = nullptr;
  // Parts of the image that are taken for flat: what they show is known already.
  std::vector<Quad> known;
};

// A connected region of one colour.
struct Region {
  bool white = false;
  int left = 0;
  int top = 0;
  int right = 0;                 // inclusive
  int bottom = 0;                // inclusive
  std::vector<PixelPoint> hull;  // convex, clockwise in the image, through centres of pixels
};

// The white (4-connected) regions within the options' sizes, and the dark (8-connected) ones of
// them that do not touch the image's border.
std::vector<Region> find_regions(const GrayView& image, const RegionOptions& options = {});

}  // namespace tagsmith::detail
