// SPDX-License-Identifier: Apache-2.0
// Where feature frames may be.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/tile_threshold.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// ---- White and dark regions of an image: local threshold, runs, connected regions.

struct RegionOptions {
  // A neighbourhood whose contrast is less than this many grey levels is flat, and white.
  int min_contrast = 20;
  // Regions smaller than this, in pixels across and down, cannot hold a readable symbol.
  int min_width = 20;
  int min_height = 12;
  // Regions larger than this, in pixels across or down, are left out.
  int max_size = std::numeric_limits<int>::max();
  // About so many changes of colour along the rows are followed, those of the greatest contrast:
  // this limits the time for images full of texture or noise.
  std::size_t max_changes = std::numeric_limits<std::size_t>::max();
  // The tiles that are searched; the others count as flat. Null = all.
  const TileMask* searched = nullptr;
  // Parts of the image that count as flat: their content is known already.
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

// ---- Candidates.

// One level of an image pyramid, or of a part of the image.
struct PyramidLevel {
  GrayView image;
  double scale = 1;        // pixels of the full image per pixel of this level
  int min_contrast = 20;   // grey levels that exceed this level's noise
  PixelPoint origin = {};  // the part's upper left pixel in the full image
};

// A quadrilateral of the level in pixels of the full image.
Quad to_full(const PyramidLevel& level, const Quad& quad);

// A quadrilateral of the full image in pixels of the level.
Quad to_level(const PyramidLevel& level, const Quad& quad);

struct CandidateOptions {
  // Frames larger than this, in pixels of the level, are left to coarser levels.
  int max_size = std::numeric_limits<int>::max();
  // Limits the time, see RegionOptions.
  std::size_t max_changes = std::numeric_limits<std::size_t>::max();
  // The tiles of the level that are searched; null = all.
  const TileMask* searched = nullptr;
  // Parts of the level that need no search.
  std::vector<Quad> known;
  // Whether pairs of regions are tried as well: something in front may have cut a frame apart.
  bool join_pieces = false;
  // Of the frames that are searched for.
  FrameShape shape;
};

// Quadrilaterals, in pixels of the level, that may be the inner edge of a feature frame: those
// around white regions, and inside those around dark ones. Accurate to a pixel or two.
std::vector<Quad> find_candidates(const PyramidLevel& level, const CandidateOptions& options = {});

}  // namespace tagsmith::detail
