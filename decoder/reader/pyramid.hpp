// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// A level and what its tiles show.
struct SearchLevel {
  PyramidLevel level;
  TextureGrid texture;
};

// The image at full, half, quarter size and so on, the coarsest first. The image's samples must
// outlive it.
class Pyramid {
 public:
  explicit Pyramid(const GrayView& image);

  const std::deque<SearchLevel>& levels() const { return levels_; }

  // The level of a half (2) or a quarter (4) of the size.
  const SearchLevel& scaled_down(int times) const {
    return levels_[levels_.size() - (times == 2 ? 2 : 3)];
  }

 private:
  const GrayView& coarsest() const { return levels_.front().level.image; }

  void add(const PyramidLevel& level) { levels_.push_front({level, texture_of(level.image)}); }

  std::deque<GrayImage> reduced_;
  std::deque<SearchLevel> levels_;
};

}  // namespace tagsmith::detail
