// SPDX-License-Identifier: Apache-2.0
// Where in a picture tags may be: what is looked at is a function of the picture and of the plates
// that are `known`, because they were read, as quadrilaterals of the level or of the full image.
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "decoder/feature_frame/bar_blocks.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/bar_regions.hpp"
#include "decoder/reader/picture_bars.hpp"
#include "decoder/reader/pyramid.hpp"
#include "decoder/reader/read_options.hpp"

namespace tagsmith {

// The outlines of a level, or, with `join_pieces`, of pairs of its regions too, that may be feature
// frames; those in the tiles `searched` alone where these are given (null = all).
std::vector<Quad> propose_outlines(const PyramidLevel& level, std::vector<Quad> known,
                                   const TileMask* searched, bool join_pieces);

// The tiles of a level around these blocks of bars, in pixels of the full image, as far as a frame
// reaches. Blocks as long as those that the next coarser level shows well are left to it.
TileMask tiles_around(const std::vector<BarBlock>& blocks, const SearchLevel& at);

// The part of the image around an expected tag at several sizes, the finest first, down to one in
// which its frame can be settled from as far off as it may be. Empty where it is out of the image.
class ExpectedSurroundings {
 public:
  ExpectedSurroundings(const GrayView& image, const ExpectedTag& expected);

  const std::vector<PyramidLevel>& levels() const { return levels_; }

 private:
  std::deque<GrayImage> reduced_;
  std::vector<PyramidLevel> levels_;
};

// The largest fields of bars in the full image, where no plate is known, that may be a symbol.
std::vector<BarRegion> propose_bars(PictureBars& bars, const PyramidLevel& half,
                                    const std::vector<Quad>& known);

// A block of bars as a region to be looked at, where it is large enough and wholly in the image.
bool may_be_followed(PictureBars& bars, const BarRegion& region);

}  // namespace tagsmith
