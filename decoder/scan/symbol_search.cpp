// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/symbol_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tagsmith/base/wide.hpp"

namespace tagsmith::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNegligible = 45;  // exp(-45) = 3e-20: less than any doubt that is stated

// Least costs of the strings that end in each character, position by position.
using LeastCosts = std::array<CharacterCosts::Row, kCharacterPlaces>;

// Of strings of the characters from kBegin up to kEnd.
template <std::size_t kBegin, std::size_t kEnd>
inline __attribute__((always_inline)) LeastCosts least_costs_between(const CharacterCosts& costs) {
  LeastCosts least;
  for (CharacterCosts::Row& row : least) row.fill(kInfinity);
  for (std::size_t c = kBegin; c < kEnd; ++c) least[0][c] = costs.constant + costs.alone[0][c];
  for (std::size_t i = 1; i < kCharacterPlaces; ++i) {
    CharacterCosts::Row row;
    row.fill(kInfinity);
    for (std::size_t a = kBegin; a < kEnd; ++a) {
      const CharacterCosts::Row& pair = costs.pair[i - 1][a];
      const double before = least[i - 1][a];
      for (std::size_t c = kBegin; c < kEnd; ++c) {
        const double cost = before + pair[c];
        row[c] = cost < row[c] ? cost : row[c];
      }
    }
    for (std::size_t c = kBegin; c < kEnd; ++c) least[i][c] = row[c] + costs.alone[i][c];
  }
  return least;
}

TAGSMITH_WIDE LeastCosts least_costs_upright(const CharacterCosts& costs) {
  return least_costs_between<0, 10>(costs);
}
TAGSMITH_WIDE LeastCosts least_costs_upside_down(const CharacterCosts& costs) {
  return least_costs_between<10, kCharacterCount>(costs);
}
TAGSMITH_WIDE LeastCosts least_costs_of_any(const CharacterCosts& costs) {
  return least_costs_between<0, kCharacterCount>(costs);
}

LeastCosts least_costs(const CharacterCosts& costs, SymbolClass symbols) {
  if (symbols == SymbolClass::upright) return least_costs_upright(costs);
  if (symbols == SymbolClass::upside_down) return least_costs_upside_down(costs);
  return least_costs_of_any(costs);
}

// How much a digit adds to the check sum at a position, so that valid symbols sum to 0 modulo 10.
std::size_t check_term(CheckDigit scheme, std::size_t position, std::size_t digit) {
  if (scheme == CheckDigit::gs1) return (position % 2 == 0 ? 3 : 1) * digit % 10;
  return position + 1 == kCharacterPlaces ? (10 - digit) % 10 : digit;
}

// Least costs of the strings that end in a digit with a check sum.
using CheckedRow = std::array<std::array<double, 10>, 10>;  // [check sum][digit]
using CheckedCosts = std::array<CheckedRow, kCharacterPlaces>;

CheckedCosts least_checked_costs(const CharacterCosts& costs, CheckDigit scheme) {
  CheckedCosts least{};
  for (CheckedRow& sums : least) {
    for (auto& row : sums) row.fill(kInfinity);
  }
  for (std::size_t c = 0; c < 10; ++c) {
    least[0][check_term(scheme, 0, c)][c] = costs.constant + costs.alone[0][c];
  }
  for (std::size_t i = 1; i < kCharacterPlaces; ++i) {
    for (std::size_t sum = 0; sum < 10; ++sum) {
      std::array<double, 10> row{};
      row.fill(kInfinity);
      for (std::size_t a = 0; a < 10; ++a) {
        const double before = least[i - 1][sum][a];
        const CharacterCosts::Row& pair = costs.pair[i - 1][a];
        for (std::size_t c = 0; c < 10; ++c) row[c] = std::min(row[c], before + pair[c]);
      }
      for (std::size_t c = 0; c < 10; ++c) {
        least[i][(sum + check_term(scheme, i, c)) % 10][c] = row[c] + costs.alone[i][c];
      }
    }
  }
  return least;
}

}  // namespace

BestSymbol best_symbol(const CharacterCosts& costs, SymbolClass symbols) {
  const LeastCosts least = least_costs(costs, symbols);
  BestSymbol best;
  const auto end = std::ranges::min_element(least[kCharacterPlaces - 1]);
  best.cost = *end;
  auto c = static_cast<std::size_t>(end - least[kCharacterPlaces - 1].begin());
  for (std::size_t i = kCharacterPlaces; i-- > 0;) {
    best.characters[i] = static_cast<std::uint8_t>(c);
    if (i == 0) break;
    std::size_t from = 0;
    double from_cost = kInfinity;
    for (std::size_t a = 0; a < kCharacterCount; ++a) {
      const double cost = least[i - 1][a] + costs.pair[i - 1][a][c];
      if (cost >= from_cost) continue;
      from_cost = cost;
      from = a;
    }
    c = from;
  }
  return best;
}

// Why: docs/decisions/0002-likelihood-decoding.md.
BestSymbol best_code(const CharacterCosts& costs, CheckDigit scheme) {
  const CheckedCosts least = least_checked_costs(costs, scheme);
  BestSymbol best;
  const auto& ends = least[kCharacterPlaces - 1][0];
  const auto end = std::ranges::min_element(ends);
  best.cost = *end;
  auto c = static_cast<std::size_t>(end - ends.begin());
  std::size_t sum = 0;
  for (std::size_t i = kCharacterPlaces; i-- > 0;) {
    best.characters[i] = static_cast<std::uint8_t>(c);
    if (i == 0) break;
    sum = (sum + 10 - check_term(scheme, i, c)) % 10;
    std::size_t from = 0;
    double from_cost = kInfinity;
    for (std::size_t a = 0; a < 10; ++a) {
      const double cost = least[i - 1][sum][a] + costs.pair[i - 1][a][c];
      if (cost >= from_cost) continue;
      from_cost = cost;
      from = a;
    }
    c = from;
  }
  return best;
}

BestSymbol best_code(const CharacterCosts& costs, std::span<const Digits> book) {
  BestSymbol best{{}, kInfinity};
  for (const Digits& digits : book) {
    const Characters characters = characters_of(digits);
    const double cost = costs.of(characters);
    if (cost < best.cost) best = {characters, cost};
  }
  return best;
}

TAGSMITH_WIDE double least_other_cost(const CharacterCosts& costs, const Characters& symbol) {
  // Least costs of the beginnings that differ from the symbol's, by their last character; and of
  // the one that does not differ.
  CharacterCosts::Row other;
  for (std::size_t c = 0; c < kCharacterCount; ++c) other[c] = costs.constant + costs.alone[0][c];
  double same = other[symbol[0]];
  other[symbol[0]] = kInfinity;
  for (std::size_t i = 1; i < kCharacterPlaces; ++i) {
    const CharacterCosts::Row& from_same = costs.pair[i - 1][symbol[i - 1]];
    CharacterCosts::Row row;
    for (std::size_t c = 0; c < kCharacterCount; ++c) row[c] = same + from_same[c];
    same = row[symbol[i]] + costs.alone[i][symbol[i]];
    row[symbol[i]] = kInfinity;
    for (std::size_t a = 0; a < kCharacterCount; ++a) {
      const CharacterCosts::Row& pair = costs.pair[i - 1][a];
      const double before = other[a];
      for (std::size_t c = 0; c < kCharacterCount; ++c) {
        const double cost = before + pair[c];
        row[c] = cost < row[c] ? cost : row[c];
      }
    }
    for (std::size_t c = 0; c < kCharacterCount; ++c) other[c] = row[c] + costs.alone[i][c];
  }
  return *std::ranges::min_element(other);
}

double sum_of_symbols(const CharacterCosts& costs, const BestSymbol& reference,
                      const CharacterWeights& weights) {
  const LeastCosts least = least_costs(costs, SymbolClass::any);
  const auto weight = [&](std::size_t position, std::size_t c) {
    if (c == reference.characters[position]) return 1.0;
    return c < 10 ? weights.digit : weights.foreign;
  };
  std::array<double, kCharacterCount> mass{};  // relative to the best string's that ends there
  for (std::size_t c = 0; c < kCharacterCount; ++c) mass[c] = weight(0, c);
  for (std::size_t i = 1; i < kCharacterPlaces; ++i) {
    std::array<double, kCharacterCount> next{};
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      const double offset = least[i][c] - costs.alone[i][c];
      double sum = 0;
      for (std::size_t a = 0; a < kCharacterCount; ++a) {
        const double excess = 0.5 * (least[i - 1][a] + costs.pair[i - 1][a][c] - offset);
        if (excess < kNegligible) sum += mass[a] * std::exp(-excess);
      }
      next[c] = sum * weight(i, c);
    }
    mass = next;
  }
  double total = 0;
  for (std::size_t c = 0; c < kCharacterCount; ++c) {
    total += mass[c] * std::exp(-0.5 * (least[kCharacterPlaces - 1][c] - reference.cost));
  }
  return total;
}

double sum_of_codes(const CharacterCosts& costs, const BestSymbol& reference, CheckDigit scheme) {
  const CheckedCosts least = least_checked_costs(costs, scheme);
  std::array<std::array<double, 10>, 10> mass{};
  for (auto& row : mass) row.fill(1);
  for (std::size_t i = 1; i < kCharacterPlaces; ++i) {
    std::array<std::array<double, 10>, 10> next{};
    for (std::size_t sum = 0; sum < 10; ++sum) {
      for (std::size_t c = 0; c < 10; ++c) {
        const std::size_t to = (sum + check_term(scheme, i, c)) % 10;
        if (least[i][to][c] == kInfinity) continue;
        const double offset = least[i][to][c] - costs.alone[i][c];
        double total = 0;
        for (std::size_t a = 0; a < 10; ++a) {
          const double excess = 0.5 * (least[i - 1][sum][a] + costs.pair[i - 1][a][c] - offset);
          if (excess < kNegligible) total += mass[sum][a] * std::exp(-excess);
        }
        next[to][c] = total;
      }
    }
    mass = next;
  }
  double total = 0;
  for (std::size_t c = 0; c < 10; ++c) {
    total += mass[0][c] * std::exp(-0.5 * (least[kCharacterPlaces - 1][0][c] - reference.cost));
  }
  return total;
}

double sum_of_codes(const CharacterCosts& costs, const BestSymbol& reference,
                    std::span<const Digits> book) {
  double total = 0;
  for (const Digits& digits : book) {
    total += std::exp((reference.cost - costs.of(characters_of(digits))) / 2);
  }
  return total;
}

}  // namespace tagsmith::detail
