// SPDX-License-Identifier: Apache-2.0
// The characters that may stand at a digit's place, the features that they are made of, and what
// each costs at every place of a symbol.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tagsmith/symbology/digits.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

// Seven modules that start and end like a digit's hold two bars and two spaces; there are twenty
// ways, and UPC-A uses ten. Characters 0-9 are the digits; 10-19 are the same widths backwards: the
// digits of an upside-down symbol, EAN-13's other left digits, and the characters that a misprint
// makes of a digit by moving one edge by a module.
inline constexpr std::size_t kCharacterCount = 20;

inline constexpr std::size_t kCharacterPlaces = kDigitCount;
using Characters = std::array<std::uint8_t, kCharacterPlaces>;

Characters characters_of(const Digits& digits);

// Seven modules of a character; in the left half it starts with a space, in the right with a bar.
const std::array<std::uint8_t, kModulesPerDigit>& modules_of_character(bool right_half,
                                                                       std::size_t c);

// Features, in order along the symbol: 2k = the growth of the edge at the begin of module k,
// 2k + 1 = module k.
inline constexpr std::size_t kFeatures = 2 * kModuleCount + 1;
inline constexpr std::size_t kOwnFeatures = 13;  // of one character, without its outer edges

// The first feature of the character at a position.
constexpr std::size_t first_feature(std::size_t position) {
  return 2 * static_cast<std::size_t>(first_module_of_digit(static_cast<int>(position))) + 1;
}

// Single precision values by character, padded to whole vectors of eight.
inline constexpr std::size_t kCharacterLanes = (kCharacterCount + 7) / 8 * 8;
using CharacterLanes = std::array<float, kCharacterLanes>;

// Which features, relative to a character's first one, a half's characters switch on.
struct Alphabet {
  static constexpr std::size_t kMostActive = 8;
  struct Active {
    std::array<std::uint8_t, kMostActive> feature{};  // ascending
    std::size_t count = 0;
  };
  std::array<Active, kCharacterCount> active{};         // by character
  std::array<CharacterLanes, kOwnFeatures> switched{};  // by feature: 1 where it is on, else 0
};

// Of the characters at a position.
const Alphabet& alphabet_at(std::size_t position);

// ---- What every character at every place of a symbol costs.

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

}  // namespace tagsmith::detail
