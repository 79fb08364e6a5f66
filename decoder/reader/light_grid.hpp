// SPDX-License-Identifier: Apache-2.0
// The light inside a feature frame as the plate shows it: straightened, upright.
#pragma once

#include <cstddef>
#include <vector>

#include "decoder/feature_frame/lens_bend.hpp"
#include "decoder/image/gray.hpp"

namespace tagsmith {

// The pixels of one small place.
struct LightCell {
  float light = 0;  // mean, 0-1
  float place = 0;  // their mean place, modules from the frame's left inner edge
  float count = 0;  // of pixels; 0 = none
};

// Cells by row (from the frame's upper inner edge to the lower one) and bin (rightwards).
struct LightGrid {
  std::size_t rows = 0;
  std::size_t bins = 0;
  double per_module = 0;  // bins
  std::vector<LightCell> cells;

  const LightCell& at(std::size_t row, std::size_t bin) const { return cells[row * bins + bin]; }
  // Middle of a row as a share of the frame's inner height, of a bin in modules.
  double height_of(std::size_t row) const {
    return (static_cast<double>(row) + 0.5) / static_cast<double>(rows);
  }
  double place_of(std::size_t bin) const { return (static_cast<double>(bin) + 0.5) / per_module; }
};

// Every pixel inside the frame counts in the cell that holds its centre. `modules` is the width of
// the frame's inside; `image_from_unit` maps the unit square onto it, P's corner first.
LightGrid light_grid(const GrayView& image, const FrameMap& image_from_unit, double modules,
                     int bins_per_module, std::size_t rows);

}  // namespace tagsmith
