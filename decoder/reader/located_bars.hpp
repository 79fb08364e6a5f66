// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/searched_image.hpp"

namespace tagsmith::detail {

// Where the bars of a symbol stand, read or not.
struct LocatedBars {
  // Module of a pixel, from the first bar on: (a + b . p) / (1 + c . p) with p = pixel - centre.
  double a = 0;
  PixelPoint b;
  PixelPoint c;
  PixelPoint centre;
  double height = 0;  // along the bars over which they were followed, pixels

  // The line of all pixels of a module: normal . (pixel - centre) + distance = 0.
  PixelPoint normal_at(double module) const { return b - module * c; }
  double distance_at(double module) const { return a - module; }
  double module_of(PixelPoint pixel) const {
    return (a + dot(b, pixel - centre)) / (1 + dot(c, pixel - centre));
  }
};

// Follows the bars of a region line by line; nothing where they do not look much like a symbol.
std::optional<LocatedBars> locate_bars(SampledLight& image, const BarRegion& region);

}  // namespace tagsmith::detail
