// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/character_costs.hpp"

namespace tagsmith::detail {

double CharacterCosts::of(const Characters& characters) const {
  double cost = constant + alone[0][characters[0]];
  for (std::size_t i = 1; i < kDigitCount; ++i) {
    cost += alone[i][characters[i]] + pair[i - 1][characters[i - 1]][characters[i]];
  }
  return cost;
}

}  // namespace tagsmith::detail
