// SPDX-License-Identifier: Apache-2.0
// What is known of codes before a profile is read, and what is known afterwards.
#pragma once

#include <optional>
#include <span>

#include "decoder/scan/profile.hpp"
#include "decoder/scan/symbol_fit.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

struct DecodeOptions {
  std::optional<CheckDigit> check;    // nothing = either scheme counts as valid
  std::span<const Digits> code_book;  // when not empty, the only codes that exist
};

// The odds of the alternatives against the digits that are read.
struct PosteriorOdds {
  double other_codes = 0;       // another code of the book or of the check digit's scheme
  double misprints = 0;         // characters that are no such code
  double corrupted_digits = 0;  // seven modules of anything that only look like the digit

  double odds() const { return other_codes + misprints + corrupted_digits; }
};

// The most likely symbol and how much more likely than every other.
struct Decoding {
  Digits digits{};
  bool upside_down = false;  // the profile runs from the symbol's end to its begin
  // Posterior probability of these digits, given that a symbol is there; 0 without closer look
  // where they explain little of the profile.
  double confidence = 0;
  PosteriorOdds doubt;  // the evidence against them; confidence is 1 / (1 + its odds)
  SymbolFit fit;
  double noise = 1;        // what the symbol leaves unexplained, over the profile's variances
  double guards = 0;       // explained_by_guards, without what was set aside
  double worst_digit = 0;  // the least of explained_by_digits, likewise
};

// The profile in the opposite direction.
ScanProfile turned(const ScanProfile& profile);

}  // namespace tagsmith::detail
