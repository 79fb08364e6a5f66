// SPDX-License-Identifier: Apache-2.0
// Grey levels between pixels, many along a line at a time.
#pragma once

#include <span>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail {

// Evenly spaced places along a line: place i is at start + (first + i) * spacing * direction.
struct PlacesOnLine {
  PixelPoint start;
  PixelPoint direction;
  int first = 0;
  double spacing = 1;

  PixelPoint at(int i) const { return start + (first + i) * spacing * direction; }
};

// What sample_bilinear() gives at each place, to the last bit. All lie in the image.
void sample_line(const GrayView& image, const PlacesOnLine& places, std::span<double> levels);

// The same in floats, faster, of places that are all inside the image and not on its last row or
// column.
void sample_line_inside(const GrayView& image, const PlacesOnLine& places, std::span<float> levels);

}  // namespace tagsmith::detail
