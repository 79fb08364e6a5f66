// SPDX-License-Identifier: Apache-2.0
// How a symbol's bars appear in a scan profile, and the adjustment of that picture to the profile.
#pragma once

#include <array>
#include <vector>

#include "decoder/scan/profile.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith {

// What lies between the ideal symbol and its profile. Nominally: no displacement, no growth, levels
// 0 and 1.
struct SymbolImage {
  double blur = 0.3;   // standard deviation of the point spread, modules
  double shift = 0;    // of the symbol's middle, modules
  double stretch = 0;  // relative change of length
  double bend = 0;     // displacement of both ends against the middle, modules
  double growth = 0;   // widening of every bar, modules
  double white = 0;    // darkness of the spaces
  double black = 1;    // darkness of the bars
  double shading = 0;  // change of both levels from the middle to the right end
};

// How well a symbol explains a profile.
struct SymbolFit {
  SymbolImage image;
  double cost = 0;       // sum of squared residuals over variances
  double explained = 0;  // share of the profile's variation that is explained, at most 1
  double kept = 1;       // share of the profile's places that were not set aside as covered
};

// Adjusts all of `start` to the profile by Gauss-Newton for the given digits. The parameters are
// held near nominal by weak priors, so that no profile can bend the symbol into another one.
SymbolFit fit_symbol(const ScanProfile& profile, const Digits& digits, const SymbolImage& start);

// What is left open of the picture of a symbol after a fit: at each place of the profile, the
// change of the darkness by one standard deviation of eight independent combinations of the
// parameters, as the profile and the priors leave them.
using FitSlack = std::vector<std::array<float, 8>>;

FitSlack slack_of_fit(const ScanProfile& profile, const SymbolImage& image, const Digits& digits);

// The darkness expected at each place of the profile.
std::vector<double> expected_darkness(const SymbolImage& image, const Digits& digits,
                                      const ScanProfile& profile);

// Share of the profile's variation about mid grey that is explained where the modules are known
// beforehand: the quiet zones, the guard patterns and the modules beside them (23 modules on three
// stretches). Near 1 for any symbol, near 0 or below for other patterns; what was set aside counts
// little. `digits` matter only for what blur carries over from the neighbouring modules.
double explained_by_guards(const ScanProfile& profile, const SymbolImage& image,
                           const Digits& digits = {});

// The digit that is explained worst: share of its variation about mid grey, as above, over its
// seven modules, beyond what the profile's variances allow. A digit with a single element edge a
// module off falls below 0.5.
double least_explained_digit(const ScanProfile& profile, const SymbolImage& image,
                             const Digits& digits);

}  // namespace tagsmith
