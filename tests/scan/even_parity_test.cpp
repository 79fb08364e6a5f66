// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "decoder/scan/elastic_scan.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tests/scan/made_profile.hpp"

using namespace tagsmith::detail;

namespace {

constexpr double kLineModule = 4;
constexpr double kLineBegin = 120;

// A line of light of a symbol of which one digit of the left half is of even parity, as EAN-13 has
// three: the right half's, seen from its end (GS1 General Specifications, 5.2.1.2).
ScanLine line_with_even_digit(const Digits& digits, std::size_t position) {
  auto modules = modules_of(digits);
  const auto first = modules.begin() + first_module_of_digit(static_cast<int>(position));
  std::reverse(first, first + kModulesPerDigit);
  for (auto at = first; at != first + kModulesPerDigit; ++at) *at = *at == 1 ? 0 : 1;
  ScanLine line;
  for (int i = 0; i < 640; ++i) {
    const auto module = static_cast<int>(std::floor((i + 0.5 - kLineBegin) / kLineModule));
    const bool bar =
        module >= 0 && module < kModuleCount && modules[static_cast<std::size_t>(module)] == 1;
    line.push_back(bar ? 0.1F : 0.8F);
  }
  return line;
}

}  // namespace

TEST_CASE("a digit of even parity is told in the left half by what it saves, whichever it is") {
  const BarTemplates templates({0.3, 0});
  const SymbolPlace place{kLineBegin, kLineModule, 0};
  for (std::uint8_t digit = 0; digit < 10; ++digit) {
    CAPTURE(digit);
    Digits digits = *parse_digits("019000700401");
    const std::size_t position = digit % 6U;
    digits[position] = digit;
    const auto placed = placed_line(line_with_even_digit(digits, position), place);
    REQUIRE(placed);
    const auto reading = read_elastic(*placed, templates);
    REQUIRE(reading);
    for (std::size_t i = 0; i < 6; ++i) {
      CAPTURE(i);
      CHECK((reading->even_parity_cost[i] < -3) == (i == position));
      if (i != position) CHECK(reading->even_parity_cost[i] > 3);
    }
  }
}
