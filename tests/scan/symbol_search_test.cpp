// SPDX-License-Identifier: Apache-2.0
// The search for the best symbol against a look at each.
#include "decoder/scan/symbol_search.hpp"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "tagsmith/symbology/digits.hpp"

using namespace tagsmith::detail;

namespace {

constexpr double kNever = 1e7;

// Symbols of one digit or another at each place.
struct TwoEach {
  std::array<std::array<std::uint8_t, 2>, kDigitCount> digits{};
  CharacterCosts costs;

  Characters symbol(unsigned which) const {
    Characters characters{};
    for (std::size_t i = 0; i < kDigitCount; ++i) characters[i] = digits[i][which >> i & 1U];
    return characters;
  }
};

TwoEach two_each(std::mt19937& random) {
  std::uniform_int_distribution<int> digit(0, 9);
  std::uniform_real_distribution<double> cost(-2, 2);
  TwoEach made;
  made.costs.constant = 7;
  for (auto& row : made.costs.alone) row.fill(kNever);
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    const int one = digit(random);
    made.digits[i] = {static_cast<std::uint8_t>(one), static_cast<std::uint8_t>((one + 5) % 10)};
    for (const std::uint8_t c : made.digits[i]) made.costs.alone[i][c] = cost(random);
  }
  for (auto& before : made.costs.pair) {
    for (auto& row : before) {
      for (double& pair : row) pair = cost(random);
    }
  }
  return made;
}

}  // namespace

TEST_CASE("sums over the codes of a scheme, and the best of them, are those of a look at each") {
  std::mt19937 random(11);
  for (int draw = 0; draw < 10; ++draw) {
    CAPTURE(draw);
    const TwoEach made = two_each(random);
    const BestSymbol reference{made.symbol(0), made.costs.of(made.symbol(0))};
    for (const CheckDigit scheme : {CheckDigit::sum10, CheckDigit::gs1}) {
      double sum = 0;
      double least = kNever;
      double sum_of_all = 0;
      for (unsigned which = 0; which < 1U << kDigitCount; ++which) {
        const Characters symbol = made.symbol(which);
        const double cost = made.costs.of(symbol);
        const double share = std::exp((reference.cost - cost) / 2);
        sum_of_all += share;
        Digits digits{};
        for (std::size_t i = 0; i < kDigitCount; ++i) digits[i] = symbol[i];
        if (!has_check_digit(scheme, digits)) continue;
        sum += share;
        least = std::min(least, cost);
      }
      CHECK(sum_of_codes(made.costs, reference, scheme) == doctest::Approx(sum).epsilon(1e-9));
      CHECK(sum_of_symbols(made.costs, reference, {}) == doctest::Approx(sum_of_all).epsilon(1e-9));
      if (sum > 0) CHECK(best_code(made.costs, scheme).cost == doctest::Approx(least));
    }
  }
}
