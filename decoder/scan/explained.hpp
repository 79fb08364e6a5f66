// SPDX-License-Identifier: Apache-2.0
// How well a symbol explains a profile, in all and where it matters.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "decoder/scan/imaging_model.hpp"
#include "decoder/scan/profile.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// The darkness expected at each place of the profile.
std::vector<double> expected_darkness(const ImagingModel& image, const Digits& digits,
                                      const ScanProfile& profile);

// Share of the profile's variation about mid grey that is explained where the modules are known
// beforehand: the quiet zones, the guard patterns and the modules beside them (23 modules on three
// stretches). Near 1 for any symbol, near 0 or below for other patterns; what was set aside counts
// little. `expected` is the darkness for any digits: they matter only for what blur carries over
// from the neighbouring modules.
double explained_by_guards(const ScanProfile& profile, const ImagingModel& image,
                           const std::vector<double>& expected);

// The digit of which a place shows a module, modules from the symbol's begin; nothing elsewhere.
std::optional<std::size_t> digit_at(double place);

// Of each digit, the share of its variation about mid grey that is explained, as above, over its
// seven modules, beyond what the profile's variances allow; 1 where nothing of it shows. A digit
// with a single element edge a module off falls below 0.5.
std::array<double, kDigitCount> explained_by_digits(const ScanProfile& profile,
                                                    const ImagingModel& image,
                                                    const std::vector<double>& expected);

// The share of the guard patterns and of the white beside them, as far as a profile shows them,
// that such a picture of them explains.
double guards_in(const ScanProfile& profile, const ImagingModel& image);

// Whether they explain as much of it as is asked before any adjustment, by this picture or by one
// that is blurrier by the standard deviation that the fit allows. A camera that takes noise away
// blurs narrow bars more than the frame's sides, by which the picture's blur is known.
bool shows_guards(const ScanProfile& profile, ImagingModel image);

}  // namespace tagsmith::detail
