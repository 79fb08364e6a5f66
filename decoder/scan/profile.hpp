// SPDX-License-Identifier: Apache-2.0
// The scan profile of a symbol: darkness along it, averaged over its bars' height.
#pragma once

#include <vector>

namespace tagsmith::detail {

// One place along the symbol.
struct ScanBin {
  double at = 0;        // modules from the symbol's first bar; its last one ends at 95
  double darkness = 0;  // 0 = the white of the plate, 1 = the black of the frame, nominally
  double variance = 1;  // of `darkness`
  double agreement =
      1;  // share of the bars' height that shows this darkness; the rest was left out
  // Standard deviation of the point spread here, over that in the symbol's middle: one blur in
  // pixels affects more modules where perspective makes them narrow.
  double spread = 1;
};

// The variance, in contrasts squared, of a place without information.
inline constexpr double kHiddenVariance = 4;

// Whether a place contains almost no information: it may be off by the whole contrast.
inline bool is_hidden(const ScanBin& bin) { return bin.variance > 1; }

// In order of `at`; places that no pixel covers are absent.
using ScanProfile = std::vector<ScanBin>;

}  // namespace tagsmith::detail
