// SPDX-License-Identifier: Apache-2.0
// What every character at every place of a symbol costs, given how bars appear in the profile.
#pragma once

#include <array>
#include <cstddef>

#include "decoder/scan/profile.hpp"
#include "decoder/scan/symbol_fit.hpp"
#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {

// Seven modules that start and end like a digit's hold two bars and two spaces; there are twenty
// ways, and UPC-A uses ten. Characters 0-9 are the digits; 10-19 are the same widths backwards: the
// digits of a symbol that stands on its head, EAN-13's other left digits, and whatever a misprint
// makes of a digit by moving one edge by a module.
inline constexpr std::size_t kCharacterCount = 20;

using Characters = std::array<std::uint8_t, kDigitCount>;

// Sum of squared residuals over variances of the symbol made of any characters:
// constant + sum of alone[i][c_i] + sum of pair[i][c_i][c_(i+1)]. Light adds up, so this is exact
// as long as blur reaches no farther than the next character.
struct CharacterCosts {
  using Row = std::array<double, kCharacterCount>;
  double constant = 0;
  std::array<Row, kDigitCount> alone{};
  std::array<std::array<Row, kCharacterCount>, kDigitCount - 1> pair{};

  double of(const Characters& characters) const;
};

// The profile as a quadratic function of the light that each module and each edge adds: everything
// the decoder needs to know of it for one picture of the symbol.
class ModuleSystem {
 public:
  ModuleSystem(const ScanProfile& profile, const SymbolImage& image);

  CharacterCosts character_costs() const;

  // The evidence that one of the symbol's digits is none at all: natural logarithm of the Bayes
  // factor of seven modules of any darkness (normally distributed about the digit's own, standard
  // deviation 0.5 of the contrast) against the digit, with residuals flattened by `temperature`; of
  // the digit for which it is greatest. Below 0 where the digit explains its place well.
  float evidence_against_digits(const Characters& characters, float temperature) const;

 private:
  // Features, in order along the symbol: 2k = the growth of the edge at the begin of module k,
  // 2k + 1 = module k.
  static constexpr std::size_t kFeatures = 2 * kModuleCount + 1;
  static constexpr std::size_t kBand = 32;
  static constexpr std::size_t kOwn = 13;  // features of one character, its outer edges left out

  float gram(std::size_t a, std::size_t b) const;
  void add(const ScanBin& bin, const SymbolImage& image, float reach,
           const std::array<float, kModuleCount + 1>& edges, std::size_t& first);
  void add_pair_costs(std::size_t position,
                      std::array<CharacterCosts::Row, kCharacterCount>& pair) const;
  void take_out(const std::array<std::uint8_t, kFeatures>& present);

  std::size_t band_ = kBand;  // features this far apart share no light
  float constant_ = 0;
  std::array<float, kFeatures> right_{};
  std::array<std::array<float, kBand>, kFeatures> gram_{};  // [a][b - a]
};

}  // namespace tagsmith
