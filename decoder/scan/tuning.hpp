// SPDX-License-Identifier: Apache-2.0
// The thresholds of reading a scan profile, one struct for each stage.
#pragma once

namespace tagsmith::detail {

// Places of symbols on a line. Tuned on rendered symbols (tests/reader/frameless_test.cpp).
struct PlaceTuning {
  float least_contrast = 0.2F;    // of the line's whole contrast: less is no bars
  float least_deviation = 0.15F;  // of the darkness of a guard pattern's modules
  // Sum over three guard patterns of 1 minus their correlation. Right places of crumpled and
  // glaring products stay below.
  double worst = 1.5;
  int slack = 3;        // modules that centre and end may be off by the begin's module
  double step = 1.045;  // from one width of a module to the next
};
inline constexpr PlaceTuning kPlace;

// Symbols on a line whose modules are not quite even. Tuned as those above.
struct ElasticTuning {
  // Squared residual of a good line: 0.14 of the contrast, much of it shared by a module's samples.
  float variance = 0.02F;
  double change_sigma = 0.05;  // of the width of modules, from a digit or guard pattern to the next
  double level_sigma = 0.15;   // of the width of modules, against the line's own
};
inline constexpr ElasticTuning kElastic;

// Weak priors of the imaging model: standard deviations of its values about their nominal ones.
// They limit what a short or empty profile leaves open, and prevent changes that would turn one
// digit into another.
struct ImagingTuning {
  double log_blur = 0.7;
  double edge = 0.35;      // modules: shift, bend, growth
  double stretch = 0.006;  // of the length
  double level = 0.3;      // of white, black and shading, of the contrast
};
inline constexpr ImagingTuning kImaging;

// The odds of the alternatives to a code: as the hostile frames of docs/accuracy.md have them
// ("Reliability"; `./dev campaign frames`). A tunnel has fewer.
// Why: docs/decisions/0003-confidence-and-refusal.md.
struct OddsTuning {
  double wrong_check = 0.02;         // a symbol whose check digit fails
  double foreign = 0.1;              // a character that is no digit
  double near_stranger = 5e-3;       // a symbol that differs from the book's in one character
  double corrupted_stranger = 2e-3;  // a corrupted digit that makes it look like the book's
  double strangers = 0.5;            // all strangers to the book together
  // Fitted on the same frames: the share of other codes and misprints that are wrong without a
  // book, over what the sums say. With a book the sums are right, and for corrupted digits too
  // large.
  double understated = 3;
  // Shares of digits with a reflection or a smear, and of covered ones; the others are never quite
  // even. Standard deviations of their modules, in contrasts. With larger shares and deviations a
  // single digit of wrong widths in a clean symbol counts as one that is lit unevenly.
  double uneven = 0.02, corrupted = 0.001;
  double even_sigma = 0.03, uneven_sigma = 0.15, corrupted_sigma = 0.5;
  // Difference of the costs of symbols, twice the logarithm of the likelihood ratio: beyond it,
  // nothing else is possible. Twenty characters at twelve places are exp(36) symbols; when each
  // costs so much more, all of them together are less likely than exp(-44).
  double decided = 160;
};
inline constexpr OddsTuning kOdds;

// Which digits and which image explain a profile, and how well.
struct DecodeTuning {
  double least_guards = 0.35;  // of the guard patterns, explained before any adjustment
  int rounds = 4;              // of digits and image in turn
  double hopeless = 0.75;      // explained, of a symbol or a digit: with less it is not believed
  double least_noise = 0.15;   // variance factor
  double noise_prior = 5;      // modules' worth of the common noise
  // Odds from which another code is a candidate of a part of a symbol, and a digit that may be
  // another one is uncertain: a less likely one counts as doubt; kSureWithBook allows more doubt
  // than twelve digits add up to.
  double candidate = 1e-7;
};
inline constexpr DecodeTuning kDecode;

}  // namespace tagsmith::detail
