// SPDX-License-Identifier: Apache-2.0
// What every character at every place of a symbol costs.
#pragma once

#include <array>

#include "decoder/scan/characters.hpp"

namespace tagsmith::detail {

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
