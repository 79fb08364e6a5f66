// SPDX-License-Identifier: Apache-2.0
// How well a symbol explains a profile; the digits and the picture of a symbol that explain it
// best, and the noise that they leave.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "decoder/scan/characters.hpp"
#include "decoder/scan/decoding.hpp"
#include "decoder/scan/imaging_model.hpp"
#include "decoder/scan/module_equations.hpp"
#include "decoder/scan/module_light.hpp"
#include "decoder/scan/profile.hpp"
#include "decoder/scan/symbol_search.hpp"
#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

// ---- How well a symbol explains a profile, as a whole and where it matters.

// The darkness expected at each place of the profile.
std::vector<double> expected_darkness(const ImagingModel& image, const Digits& digits,
                                      const ScanProfile& profile);

// Share of the profile's variation about mid grey that is explained where the modules are known
// beforehand: the quiet zones, the guard patterns and the modules beside them (23 modules on three
// stretches). Near 1 for any symbol, near 0 or below for other patterns; what was set aside counts
// little. `expected` is the darkness for any digits: they matter only because of the blur from the
// neighbouring modules.
double explained_by_guards(const ScanProfile& profile, const ImagingModel& image,
                           const std::vector<double>& expected);

// The digit of which a place shows a module, modules from the symbol's begin; nothing elsewhere.
std::optional<std::size_t> digit_at(double place);

// For each digit, the share of its variation about mid grey that is explained, as above, over its
// seven modules, beyond what the profile's variances allow; 1 where nothing of it is visible. A
// digit with a single element edge a module off falls below 0.5.
std::array<double, kDigitCount> explained_by_digits(const ScanProfile& profile,
                                                    const ImagingModel& image,
                                                    const std::vector<double>& expected);

// The share of the guard patterns and of the white beside them, as far as a profile shows them,
// that such a picture of them explains.
double guards_in(const ScanProfile& profile, const ImagingModel& image);

// Whether they explain as much of it as is required before any adjustment, with this picture or
// with one that is blurrier by the standard deviation that the fit allows. Noise reduction in a
// camera blurs narrow bars more than the frame's sides, which determine the picture's blur.
bool shows_guards(const ScanProfile& profile, ImagingModel image);

// ---- The digits and the picture of a symbol that explain a profile best, and the noise that they
// leave: what decoding a whole symbol and a part of one have in common.

// The schemes by which a code may be valid.
std::span<const CheckDigit> schemes_of(const DecodeOptions& options);

Digits digits_of(const Characters& characters);

// The most likely code among those that may exist.
BestSymbol best_of(const CharacterCosts& costs, const DecodeOptions& options);

// Odds that refute the digits.
inline constexpr PosteriorOdds kRefuted{std::numeric_limits<double>::infinity(), 0, 0};

// How a profile is read at first: with the picture of the symbol that it starts from.
struct DecodingStart {
  explicit DecodingStart(const ScanProfile& profile, const ImagingModel& picture)
      : image(picture),
        light(profile, picture),
        costs(ModuleNormalEquations(profile, light).character_costs()) {}

  ImagingModel image;
  ModuleLight light;
  CharacterCosts costs;
};

// Digits and a picture that fit each other, and the quantities that they were found with.
struct Settled {
  Decoding decoding;
  ModuleLight light;             // by the picture of the decoding
  ModuleNormalEquations system;  // of the profile, by that light
};

// The best explanation of a profile in its right direction, not yet judged.
struct Explained {
  Settled settled;
  std::array<double, kDigitCount> digits{};  // explained_by_digits
};

// Nothing where no picture of a symbol fits.
std::optional<Explained> explain(const ScanProfile& profile, const DecodingStart& start,
                                 const DecodeOptions& options);

// The directions in which a symbol may run along a profile, by the cost of its digits at first.
struct PossibleWays {
  bool up = false;
  bool down = false;
};
PossibleWays possible_ways(const ScanProfile& profile, const CharacterCosts& costs);

// Which modules of a symbol a profile shows.
using ModulesShown = std::array<bool, kModuleCount>;

constexpr ModulesShown all_modules() {
  ModulesShown shown{};
  shown.fill(true);
  return shown;
}

// By how much the profile's variances are less than the squares that the symbol leaves unexplained:
// about each module, and in most of the symbol. Dirt or light in one place must neither count for
// all of it, nor be averaged away in it.
struct VarianceFactors {
  std::array<double, kModuleCount> local{};
  double common = 0;
};

// From the misfits of the profile to the modules that it shows.
VarianceFactors variance_factors_of(const std::array<float, kModuleCount>& misfits,
                                    const ModulesShown& shown);

ScanProfile with_local_noise(ScanProfile profile, const VarianceFactors& factors);
ScanProfile with_common_noise(ScanProfile profile, const VarianceFactors& factors);

}  // namespace tagsmith::detail
