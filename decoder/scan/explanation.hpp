// SPDX-License-Identifier: Apache-2.0
// The digits and the picture of a symbol that explain a profile best, and the noise that they
// leave: what decoding a whole symbol and a part of one have in common.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>

#include "decoder/scan/character_costs.hpp"
#include "decoder/scan/decoding.hpp"
#include "decoder/scan/imaging_model.hpp"
#include "decoder/scan/module_equations.hpp"
#include "decoder/scan/module_light.hpp"
#include "decoder/scan/profile.hpp"
#include "decoder/scan/symbol_search.hpp"
#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

// The schemes by which a code may be valid.
std::span<const CheckDigit> schemes_of(const DecodeOptions& options);

Digits digits_of(const Characters& characters);

// The most likely code among those that may exist.
BestSymbol best_of(const CharacterCosts& costs, const DecodeOptions& options);

// Nothing is left of the digits.
inline constexpr PosteriorOdds kRefuted{std::numeric_limits<double>::infinity(), 0, 0};

// How a profile is read at first: by the picture of the symbol that it starts from.
struct DecodingStart {
  explicit DecodingStart(const ScanProfile& profile, const ImagingModel& picture)
      : image(picture),
        light(profile, picture),
        costs(ModuleNormalEquations(profile, light).character_costs()) {}

  ImagingModel image;
  ModuleLight light;
  CharacterCosts costs;
};

// Digits and a picture that fit each other, and what that was found by.
struct Settled {
  Decoding decoding;
  ModuleLight light;             // by the picture of the decoding
  ModuleNormalEquations system;  // of the profile, by that light
};

// What explains a profile seen the right way round, not yet judged.
struct Explained {
  Settled settled;
  std::array<double, kDigitCount> digits{};  // explained_by_digits
};

// Nothing where no picture of a symbol fits.
std::optional<Explained> explain(const ScanProfile& profile, const DecodingStart& start,
                                 const DecodeOptions& options);

// The ways in which a symbol may run along a profile, by what its digits cost at first.
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

// By how much the profile's variances fall short of what the symbol leaves unexplained: about each
// module, and in most of the symbol. What dirt or light leave in one place must not count for all
// of it, nor be lost in all of it.
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
