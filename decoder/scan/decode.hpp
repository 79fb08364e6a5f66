// SPDX-License-Identifier: Apache-2.0
// Scan profile -> digits, by maximum likelihood over whole symbols.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "decoder/scan/profile.hpp"
#include "decoder/scan/symbol_fit.hpp"
#include "tagsmith/symbology/digits.hpp"

namespace tagsmith::detail {

struct DecodeOptions {
  std::optional<CheckDigit> check;    // nothing = either scheme counts as valid
  std::span<const Digits> code_book;  // when not empty, the only codes that exist
};

// The odds of what else could be there, against the digits that are read.
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
  PosteriorOdds doubt;  // what speaks against them; confidence is 1 / (1 + its odds)
  SymbolFit fit;
  double noise = 1;        // what the symbol leaves unexplained, over the profile's variances
  double guards = 0;       // explained_by_guards, without what was set aside
  double worst_digit = 0;  // least_explained_digit, likewise
};

// Starts from the given picture of the symbol (its blur is the one that matters) and alternates
// between the most likely digits, exact by dynamic programming over neighbouring digits, and the
// adjustment of the picture to them. The profile must have at least 40 places.
std::optional<Decoding> decode_profile(const ScanProfile& profile, const ImagingModel& start,
                                       const DecodeOptions& options);

// A code of the book that a part of a symbol may belong to.
struct PartCandidate {
  Digits digits{};
  double odds = 1;  // against the likeliest, by the digits in sight
};

// What a profile of a part of a symbol shows. Of the decoding, `digits` are the likeliest
// candidate's, and `confidence` and `doubt` speak of the digits in sight alone: that they are those
// of one of the candidates. Whether another plate with the same digits in sight stands there, they
// do not say.
struct PartDecoding {
  Decoding decoding;
  std::array<bool, kDigitCount> in_sight{};  // the digits all of whose modules the profile shows
  std::vector<PartCandidate> candidates{};   // likeliest first; not empty
};

// As decode_profile, of a profile that begins or ends amid the symbol, against a code book, which
// must not be empty. Codes that differ in no digit in sight are candidates alike.
// Why: docs/decisions/0025-parts-of-tags.md.
std::optional<PartDecoding> decode_part(const ScanProfile& profile, const ImagingModel& start,
                                        const DecodeOptions& options);

// The profile seen the other way round.
ScanProfile turned(const ScanProfile& profile);

// By what logarithm of the likelihood ratio another symbol, of any characters, explains a profile
// of the same symbol better than these digits, by the decoding's noise: 0 where none does.
double log_odds_of_another(const ScanProfile& profile, const Decoding& decoding);

}  // namespace tagsmith::detail
