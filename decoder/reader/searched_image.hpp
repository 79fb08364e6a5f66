// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/pyramid.hpp"
#include "decoder/reader/sampled_light.hpp"

namespace tagsmith::detail {

// One picture and what all who look for tags and bars in it share, made when it is first wanted.
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
