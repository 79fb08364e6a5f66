// SPDX-License-Identifier: Apache-2.0
// The most likely symbols given the cost of each character, and how likely all others are together.
#pragma once

#include <span>

#include "decoder/scan/characters.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

// The symbols that are considered.
enum class SymbolClass {
  upright,      // any twelve digits
  upside_down,  // any twelve digits of an upside-down symbol
  any,          // any twelve characters
};

// The best symbol of a class.
struct BestSymbol {
  Characters characters{};
  double cost = 0;
};

// Exact, by dynamic programming over neighbouring characters.
BestSymbol best_symbol(const CharacterCosts& costs, SymbolClass symbols);

// The best code whose check digit holds under the scheme.
BestSymbol best_code(const CharacterCosts& costs, CheckDigit scheme);

// The best code of a book, which must not be empty.
BestSymbol best_code(const CharacterCosts& costs, std::span<const Digits> book);

// The least cost of all symbols, of any characters, other than this one.
double least_other_cost(const CharacterCosts& costs, const Characters& symbol);

// How often a character other than the reference's occurs, as far as is known beforehand.
struct CharacterWeights {
  double digit = 1;
  double foreign = 1;  // one that is no digit
};

// Sums of exp(-(cost - reference.cost) / 2), exact too: over all symbols, each character that
// differs from the reference's weighted; over the codes of a scheme; over a book.
double sum_of_symbols(const CharacterCosts& costs, const BestSymbol& reference,
                      const CharacterWeights& weights);
double sum_of_codes(const CharacterCosts& costs, const BestSymbol& reference, CheckDigit scheme);
double sum_of_codes(const CharacterCosts& costs, const BestSymbol& reference,
                    std::span<const Digits> book);

}  // namespace tagsmith::detail
