// SPDX-License-Identifier: Apache-2.0
// Lines of light across the bars of a region.
#pragma once

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/image/gray.hpp"
#include "decoder/reader/searched_image.hpp"
#include "decoder/scan/elastic_scan.hpp"

namespace tagsmith::detail {

// A region's own axes: a line runs `across` the bars, and averages `along` them.
struct LineFrame {
  PixelPoint centre;
  PixelPoint across;  // unit vectors; not quite perpendicular where bars lean
  PixelPoint along;
  double step = 0.5;  // pixels from one sample of a line to the next
  double begin = 0;   // of the first sample's near edge, pixels from the centre
  std::size_t count = 0;
  // By what share steps shrink a pixel towards the end of the line, at its centre: bars that run
  // away from the camera then follow each other evenly.
  double foreshortening = 0;

  // The pixel under a place of a line at an offset along the bars; sample i covers i to i + 1.
  PixelPoint pixel(double place, double offset) const {
    const double even = begin + place * step;
    return centre + even / (1 + foreshortening / 2 * even) * across + offset * along;
  }
};

// Axes for lines that reach beyond the region by half its length on both sides, as far as the
// image does, with the bars' direction such that the mean over the region's height is sharpest.
LineFrame line_frame_for(SampledLight& light, const BarRegion& region);

// Mean light of the line at `offset` pixels along the bars, over `thickness` pixels of their
// length.
ScanLine light_along(SampledLight& light, const LineFrame& frame, double offset, double thickness);

// Whether one of three lines across a region shows at least so many bars, of which a symbol has 30:
// a quick check.
bool has_bars(const GrayView& image, const BarRegion& region, int least);

}  // namespace tagsmith::detail
