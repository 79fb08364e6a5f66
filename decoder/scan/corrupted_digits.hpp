// SPDX-License-Identifier: Apache-2.0
// Whether digits may be other ones, corrupted until they look like these.
#pragma once

#include <array>
#include <cstddef>

#include "decoder/scan/characters.hpp"

namespace tagsmith::detail {

// A digit's profile as a quadratic function of the darkness of its modules. The growth of the edges
// stays as it is: what one edge has of its own must not speak for a digit without it.
struct DigitModules {
  static constexpr std::size_t kModules = kModulesPerDigit;
  std::array<double, kModules> residuals{};                       // what the digit leaves
  std::array<std::array<double, kModules>, kModules> products{};  // of the modules' light
};

// Of each of the digits, all of them of 0 to 9, the odds that it is another.
std::array<double, kDigitCount> odds_of_corrupted_digits(
    const std::array<DigitModules, kDigitCount>& modules, const Characters& digits);

}  // namespace tagsmith::detail
