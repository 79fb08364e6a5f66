// SPDX-License-Identifier: Apache-2.0
// What all who look for bars in one picture share.
#pragma once

#include "decoder/image/gray.hpp"
#include "decoder/reader/bar_regions.hpp"
#include "decoder/reader/sampled_light.hpp"

namespace tagsmith {

// Made of the image as far as it is wanted, once. The image's samples must outlive it.
struct PictureBars {
  explicit PictureBars(const GrayView& image) : light(image), regions(image) {}

  SampledLight light;
  BarRegions regions;
};

}  // namespace tagsmith
