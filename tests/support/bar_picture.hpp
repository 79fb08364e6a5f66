// SPDX-License-Identifier: Apache-2.0
// Pictures of plain symbols, without plate and frame, as a phone may take them of a product.
#pragma once

#include <cstdint>
#include <vector>

#include "decoder/image/gray.hpp"

namespace tagsmith::detail::test {

// How a picture of bars is taken.
struct BarPicture {
  double module_px = 2;        // in the middle
  double height_modules = 60;  // of the bars
  double margin_modules = 12;  // of plain paper around the bars
  double roll = 0;             // radians
  double incidence = 0;        // turned about the bars' direction, radians; mild perspective
  double bend = 0;             // half of the angle of a cylinder that the bars cover, radians
  double crumple = 0;          // amplitude of a smooth displacement along the symbol, modules
  double blur_px = 0.6;
  double noise = 2;   // grey levels
  double growth = 0;  // of the bars, modules
  double ink = 0.08;  // reflectances
  double paper = 0.75;
  double glare = 0;  // light added in a blob over part of the bars
  std::uint64_t seed = 1;
};

// Bars and spaces of these widths in modules, bar first.
GrayImage picture_of(const std::vector<int>& element_widths, const BarPicture& how);

}  // namespace tagsmith::detail::test
