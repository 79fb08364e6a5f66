// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/symbology/upca.hpp"

#include <algorithm>

namespace tagsmith::detail {

std::array<std::uint8_t, kElementCount> elements_of(const Digits& digits) {
  std::array<std::uint8_t, kElementCount> elements{};
  elements.fill(1);
  for (int i = 0; i < kDigitCount; ++i) {
    const auto& widths = kDigitElements[digits[static_cast<std::size_t>(i)]];
    std::copy(widths.begin(), widths.end(), elements.begin() + first_element_of_digit(i));
  }
  return elements;
}

std::array<std::uint8_t, kModuleCount> modules_of(const Digits& digits) {
  std::array<std::uint8_t, kModuleCount> modules{};
  auto module = modules.begin();
  std::uint8_t bar = 1;
  for (const std::uint8_t width : elements_of(digits)) {
    module = std::fill_n(module, width, bar);
    bar = bar == 1 ? 0 : 1;
  }
  return modules;
}

}  // namespace tagsmith::detail
