// SPDX-License-Identifier: Apache-2.0
// UPC-A: twelve digits -> 59 elements -> 95 modules (ISO/IEC 15420; Xu et al. 2017, Table 1).
#pragma once

#include <array>
#include <cstdint>

#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

inline constexpr int kModuleCount = 95;
inline constexpr int kElementCount = 59;
inline constexpr int kModulesPerDigit = 7;
inline constexpr int kElementsPerDigit = 4;
inline constexpr int kWidestElement = 4;  // modules
// Modules to either side of a place among which there are bars and spaces.
inline constexpr int kNearModules = kWidestElement + 1;
inline constexpr int kQuietZoneModules = 9;  // GS1 General Specifications 5.2.3.4

// Widths of a digit's four elements in modules. The left half of the symbol starts each digit with
// a space, the right half with a bar; the widths are the same.
inline constexpr std::array<std::array<std::uint8_t, kElementsPerDigit>, 10> kDigitElements{{
    {3, 2, 1, 1},
    {2, 2, 2, 1},
    {2, 1, 2, 2},
    {1, 4, 1, 1},
    {1, 1, 3, 2},
    {1, 2, 3, 1},
    {1, 1, 1, 4},
    {1, 3, 1, 2},
    {1, 2, 1, 3},
    {3, 1, 1, 2},
}};

// Module index (0-94) at which digit `index` (0-11) begins: after the start guard, and for the
// right half after the centre guard too.
constexpr int first_module_of_digit(int index) {
  return 3 + kModulesPerDigit * index + (index >= 6 ? 5 : 0);
}

// Element index (0-58) at which digit `index` begins.
constexpr int first_element_of_digit(int index) {
  return 3 + kElementsPerDigit * index + (index >= 6 ? 5 : 0);
}

// Widths in modules of all elements: bars at even indices, spaces at odd ones.
std::array<std::uint8_t, kElementCount> elements_of(const Digits& digits);

// 1 = bar, 0 = space, left to right.
std::array<std::uint8_t, kModuleCount> modules_of(const Digits& digits);

}  // namespace tagsmith::detail
