// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/symbology/upca.hpp"

#include <algorithm>

namespace tagsmith {
namespace {

bool is_guard(std::span<const std::uint8_t> elements) {
  return std::all_of(elements.begin(), elements.end(),
                     [](std::uint8_t width) { return width == 1; });
}

std::optional<std::uint8_t> digit_of(std::span<const std::uint8_t> elements) {
  for (std::uint8_t digit = 0; digit < 10; ++digit) {
    if (std::ranges::equal(kDigitElements[digit], elements)) return digit;
  }
  return std::nullopt;
}

}  // namespace

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

std::optional<Digits> digits_of_elements(std::span<const std::uint8_t, kElementCount> elements) {
  constexpr int kCentreGuard = first_element_of_digit(6) - 5;
  if (!is_guard(elements.first(3)) || !is_guard(elements.subspan(kCentreGuard, 5)) ||
      !is_guard(elements.last(3))) {
    return std::nullopt;
  }
  Digits digits{};
  for (int i = 0; i < kDigitCount; ++i) {
    const auto first = static_cast<std::size_t>(first_element_of_digit(i));
    const std::optional<std::uint8_t> digit = digit_of(elements.subspan(first, kElementsPerDigit));
    if (!digit) return std::nullopt;
    digits[static_cast<std::size_t>(i)] = *digit;
  }
  return digits;
}

}  // namespace tagsmith
