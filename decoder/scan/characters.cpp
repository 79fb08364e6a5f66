// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/characters.hpp"

#include <algorithm>

namespace tagsmith::detail {
namespace {

using CharacterModules = std::array<std::uint8_t, kModulesPerDigit>;

constexpr CharacterModules modules_by_widths(bool right_half, std::size_t c) {
  std::array<std::uint8_t, kElementsPerDigit> widths = kDigitElements[c % 10];
  if (c >= 10) std::ranges::reverse(widths);
  CharacterModules modules{};
  std::size_t at = 0;
  std::uint8_t bar = right_half ? 1 : 0;
  for (const std::uint8_t width : widths) {
    for (int i = 0; i < width; ++i) modules[at++] = bar;
    bar ^= 1U;
  }
  return modules;
}

constexpr auto kModulesOfCharacters = [] {
  std::array<std::array<CharacterModules, kCharacterCount>, 2> modules{};
  for (std::size_t c = 0; c < kCharacterCount; ++c) {
    modules[0][c] = modules_by_widths(false, c);
    modules[1][c] = modules_by_widths(true, c);
  }
  return modules;
}();

Alphabet::Active active_features(bool right_half, std::size_t c) {
  const auto modules = modules_of_character(right_half, c);
  Alphabet::Active active;
  for (std::size_t k = 0; k < modules.size(); ++k) {
    if (k > 0 && modules[k] != modules[k - 1]) {
      active.feature[active.count++] = static_cast<std::uint8_t>(2 * k - 1);
    }
    if (modules[k] != 0) active.feature[active.count++] = static_cast<std::uint8_t>(2 * k);
  }
  return active;
}

Alphabet alphabet_of(bool right_half) {
  Alphabet alphabet;
  for (std::size_t c = 0; c < kCharacterCount; ++c) {
    const Alphabet::Active active = active_features(right_half, c);
    for (std::size_t i = 0; i < active.count; ++i) alphabet.switched[active.feature[i]][c] = 1;
    alphabet.active[c] = active;
  }
  return alphabet;
}

}  // namespace

Characters characters_of(const Digits& digits) {
  Characters characters{};
  std::ranges::copy(digits, characters.begin());
  return characters;
}

const std::array<std::uint8_t, kModulesPerDigit>& modules_of_character(bool right_half,
                                                                       std::size_t c) {
  return kModulesOfCharacters[right_half ? 1 : 0][c];
}

const Alphabet& alphabet_at(std::size_t position) {
  static const std::array<Alphabet, 2> kHalves{alphabet_of(false), alphabet_of(true)};
  return kHalves[position < 6 ? 0 : 1];
}

// ---- Costs.

double CharacterCosts::of(const Characters& characters) const {
  double cost = constant + alone[0][characters[0]];
  for (std::size_t i = 1; i < kDigitCount; ++i) {
    cost += alone[i][characters[i]] + pair[i - 1][characters[i - 1]][characters[i]];
  }
  return cost;
}

}  // namespace tagsmith::detail
