// SPDX-License-Identifier: Apache-2.0
// One picture and what all searches for tags and bars in it share: its light, its levels, its bars.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// ---- The light of a picture's grey levels, for functions that sample much of it.

// The light (0-1, of the sRGB tone curve) of an image's pixels, row by row, each row computed when
// it is first used. The image's samples must outlive it.
class SampledLight {
 public:
  explicit SampledLight(const GrayView& image);

  const GrayView& image() const { return image_; }
  int width() const { return image_.width; }
  int height() const { return image_.height; }

  // Computes the rows from `first` to `last`, as far as the image has them.
  void make_rows(int first, int last);

  // A row that was computed.
  const float* row(int y) const {
    return light_.get() + static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width);
  }

 private:
  GrayView image_;
  std::unique_ptr<float[]> light_;  // of all rows, once one was used
  std::vector<bool> made_;
};

// ---- Levels.

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

// ---- The picture.

// One picture and what all searches for tags and bars in it share, computed when it is first used.
// The image's samples must outlive it.
class SearchedImage {
 public:
  explicit SearchedImage(const GrayView& image) : light(image) {}

  const GrayView& image() const { return light.image(); }

  const Pyramid& pyramid();

  // The largest regions of bars that the picture shows at any of its levels, in pixels of the full
  // image, largest first. In images of more than two million pixels the full level is not looked
  // at, so that modules below about one pixel of the next one are missed.
  const std::vector<BarRegion>& bars();

  SampledLight light;

 private:
  std::optional<Pyramid> pyramid_;
  std::optional<std::vector<BarRegion>> bars_;
};

}  // namespace tagsmith::detail
