// SPDX-License-Identifier: Apache-2.0
// What every character at every place of a symbol costs, given how bars appear in the profile.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

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
// where blur reaches no farther than the next character. Where it does, it is exact for symbols in
// which no two characters that far apart differ from the reference.
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
  // With `slack`, the picture adapts to each symbol as far as it leaves: costs about a reference
  // are then those after a fit of the picture to each symbol, linearized.
  ModuleSystem(const ScanProfile& profile, const SymbolImage& image, const FitSlack& slack = {});

  // With a reference, what characters share beyond their neighbours is taken from it, and the
  // picture adapts to what differs from it; without, both are left out.
  CharacterCosts character_costs(const Characters* reference = nullptr) const;

  // How far the profile is from the symbol of these characters, module by module: the square of the
  // residuals' projection on the light of each module, over its variance. About 1 where the
  // profile's variances tell all that the symbol does not explain.
  std::array<float, kModuleCount> misfits(const Characters& characters) const;

  // The odds that one of the digits is another one, spoilt by anything that makes it look like
  // this: modules of any darkness about that digit's, against modules that are printed and lit
  // nearly evenly, or spoilt too, about this one's.
  double odds_of_spoilt_digits(const Characters& characters) const;

 private:
  // Features, in order along the symbol: 2k = the growth of the edge at the begin of module k,
  // 2k + 1 = module k.
  static constexpr std::size_t kFeatures = 2 * kModuleCount + 1;
  static constexpr std::size_t kBand = 64;
  static constexpr std::size_t kOwn = 13;  // features of one character, its outer edges left out

  float gram(std::size_t a, std::size_t b) const;
  std::array<float, kFeatures> residuals_of(const Characters& characters) const;
  class SpoiltDigit;
  static constexpr std::size_t kSlack = std::tuple_size_v<FitSlack::value_type>;
  using Pull = std::array<float, kSlack>;

  void add(const ScanBin& bin, const SymbolImage& image, const Pull* slack,
           const std::array<float, kModuleCount + 1>& edges, std::size_t& first);
  void add_pair_costs(std::size_t position,
                      std::array<CharacterCosts::Row, kCharacterCount>& pair) const;
  void add_far_costs(const Characters& reference, CharacterCosts& costs) const;
  void adapt_picture(const Characters& reference, CharacterCosts& costs) const;
  void take_out(const std::array<std::uint8_t, kFeatures>& present);

  std::size_t band_ = kBand;  // features this far apart share no light
  float constant_ = 0;
  bool adapts_ = false;
  std::array<float, kFeatures> right_{};
  std::array<Pull, kFeatures> pull_{};                      // of a feature on the picture
  std::array<std::array<float, kBand>, kFeatures> gram_{};  // [a][b - a]
};

}  // namespace tagsmith
