// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

inline constexpr float kHalfLength = kModuleCount / 2.0F;  // of a symbol, modules

// How the profile differs from the ideal symbol. Nominally: no displacement, no growth, levels 0
// and 1. All but the pixels' width is fitted.
struct ImagingModel {
  double blur = 0.3;   // standard deviation of the point spread, modules
  double shift = 0;    // of the symbol's middle, modules
  double stretch = 0;  // relative change of length
  double bend = 0;     // displacement of both ends against the middle, modules
  double growth = 0;   // widening of every bar, modules
  double white = 0;    // darkness of the spaces
  double black = 1;    // darkness of the bars
  double shading = 0;  // change of both levels from the middle to the right end
  double pixel = 0;    // width that a place averages over, modules in the symbol's middle

  // Where a module of the symbol is seen, without growth.
  double place_of(double module) const {
    const double from_middle = module - kModuleCount / 2.0;
    const double t = 2 * from_middle / kModuleCount;
    return module + shift + stretch * from_middle + bend * t * t;
  }
};

}  // namespace tagsmith::detail
