// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/decode.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "decoder/scan/character_costs.hpp"
#include "decoder/scan/symbol_search.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

Digits digits_of(const Characters& characters) {
  Digits digits{};
  std::ranges::copy(characters, digits.begin());
  return digits;
}

// Seen the other way round.
ScanProfile turned(const ScanProfile& profile) {
  ScanProfile result(profile.rbegin(), profile.rend());
  for (ScanBin& bin : result) bin.at = kModuleCount - bin.at;
  return result;
}

std::span<const CheckDigit> schemes_of(const DecodeOptions& options) {
  static constexpr std::array<CheckDigit, 2> kBoth{CheckDigit::sum10, CheckDigit::gs1};
  if (!options.check) return kBoth;
  return {&*options.check, 1};
}

// The most likely code among those that may exist.
BestSymbol best_of(const CharacterCosts& costs, const DecodeOptions& options) {
  if (!options.code_book.empty()) return best_code(costs, options.code_book);
  // Where the best symbol of all is a valid code, nothing is left to search.
  const BestSymbol free = best_symbol(costs, SymbolClass::upright);
  const Digits digits = digits_of(free.characters);
  BestSymbol best{{}, std::numeric_limits<double>::infinity()};
  for (const CheckDigit scheme : schemes_of(options)) {
    if (has_check_digit(scheme, digits)) return free;
  }
  for (const CheckDigit scheme : schemes_of(options)) {
    const BestSymbol found = best_code(costs, scheme);
    if (found.cost < best.cost) best = found;
  }
  return best;
}

// Posterior of the best code: against the other codes that may exist, and, with a small prior,
// every other string of characters, so that neither a symbol whose check digit fails, nor one with
// a misshapen digit, nor a stranger to the code book is bent into a code.
double posterior(const CharacterCosts& costs, const DecodeOptions& options, const BestSymbol& best,
                 double temperature) {
  constexpr double kPriorOfOthers = 0.03;  // of all symbols together that are no code
  constexpr double kForeign = 0.3;         // of a character that is no digit, against one that is
  constexpr double kCodesPerSymbol = 0.1;
  // A book's codes are near each other, and so are its strangers to them, misprints above all: the
  // fewer characters differ, the likelier.
  constexpr double kDiffers = 1e-6;
  constexpr double kLeastDoubt = 1e-12;
  const bool with_book = !options.code_book.empty();
  const CharacterWeights weights =
      with_book ? CharacterWeights{kDiffers, kForeign * kDiffers} : CharacterWeights{1, kForeign};
  const double others = std::max(0.0, sum_of_symbols(costs, best, temperature, weights) - 1);
  double rivals = 0;
  if (with_book) {
    rivals = sum_of_codes(costs, best, temperature, options.code_book) - 1 + others;
  } else if (others < kLeastDoubt) {
    rivals = others;  // the codes are among them
  } else {
    for (const CheckDigit scheme : schemes_of(options)) {
      const bool holds = has_check_digit(scheme, digits_of(best.characters));
      rivals += sum_of_codes(costs, best, temperature, scheme) - (holds ? 1 : 0);
    }
    rivals += kPriorOfOthers * kCodesPerSymbol * others;
  }
  // Fitted on simulated frames: where the sums state a doubt of 10^-2n, about one reading in 10^n
  // is wrong (docs/accuracy.md, "Reliability").
  const double doubt = std::max(0.0, rivals) / (1 + std::max(0.0, rivals));
  return 1 - std::sqrt(doubt);
}

// Alternates between the most likely digits and the adjustment of the picture to them.
std::optional<Decoding> settle(const ScanProfile& profile, const SymbolImage& start,
                               const DecodeOptions& options) {
  constexpr int kMaxRounds = 4;
  Decoding decoding;
  SymbolImage image = start;
  for (int round = 0; round < kMaxRounds; ++round) {
    const CharacterCosts costs = ModuleSystem(profile, image).character_costs();
    const Digits digits = digits_of(best_of(costs, options).characters);
    if (round > 0 && digits == decoding.digits) break;
    decoding.digits = digits;
    SymbolImage from = start;
    from.blur = image.blur;
    decoding.fit = fit_symbol(profile, decoding.digits, from);
    image = decoding.fit.image;
    if (!(image.black - image.white > 0.05)) return std::nullopt;
  }
  return decoding;
}

// The profile with the places that the symbol cannot explain given almost no weight, and the share
// of places that keep theirs. Only places where the bars' height disagrees with itself may be set
// aside: dirt, glare and cables have outlines, whereas a bar that is not ours looks alike all
// along.
struct Cleaned {
  ScanProfile profile;
  double kept = 1;
};

Cleaned set_aside_outliers(const ScanProfile& profile, const Decoding& decoding) {
  constexpr double kTolerance = 0.12;  // of the contrast, beside the noise
  constexpr double kAgreement = 0.85;
  constexpr double kCoveredVariance = 4;
  Cleaned cleaned{profile, 1};
  std::size_t covered = 0;
  const SymbolImage& image = decoding.fit.image;
  const std::vector<double> expected = expected_darkness(image, decoding.digits, profile);
  for (std::size_t i = 0; i < profile.size(); ++i) {
    if (profile[i].agreement > kAgreement) continue;
    const double residual = std::abs(profile[i].darkness - expected[i]);
    const double contrast = image.black - image.white;
    if (residual < kTolerance * contrast + 3.5 * std::sqrt(profile[i].variance)) continue;
    cleaned.profile[i].variance = kCoveredVariance;
    ++covered;
  }
  cleaned.kept = 1 - static_cast<double>(covered) / static_cast<double>(profile.size());
  return cleaned;
}

// Decodes a profile seen the right way round.
std::optional<Decoding> decode_upright(const ScanProfile& profile, const SymbolImage& start,
                                       const DecodeOptions& options) {
  constexpr double kNearlyAll = 0.985;  // explained: nothing to set aside
  constexpr int kMaxCleanings = 3;
  std::optional<Decoding> decoding = settle(profile, start, options);
  Cleaned cleaned{profile, 1};
  for (int i = 0; decoding && i < kMaxCleanings && decoding->fit.explained < kNearlyAll; ++i) {
    Cleaned next = set_aside_outliers(profile, *decoding);
    if (next.kept == cleaned.kept) break;
    cleaned = std::move(next);
    decoding = settle(cleaned.profile, start, options);
  }
  if (!decoding) return std::nullopt;
  decoding->fit.kept = cleaned.kept;
  decoding->guards = explained_by_guards(cleaned.profile, decoding->fit.image, decoding->digits);
  decoding->worst_digit =
      least_explained_digit(cleaned.profile, decoding->fit.image, decoding->digits);
  const double per_place =
      decoding->fit.cost / (cleaned.kept * static_cast<double>(profile.size()));
  const double temperature = options.flattening * std::max(1.0, per_place);
  const ModuleSystem system(cleaned.profile, decoding->fit.image);
  const CharacterCosts costs = system.character_costs();
  const BestSymbol best = best_of(costs, options);
  decoding->against_digits = static_cast<double>(
      system.evidence_against_digits(best.characters, static_cast<float>(temperature)));
  decoding->confidence = digits_of(best.characters) == decoding->digits
                             ? posterior(costs, options, best, temperature)
                             : 0;
  return decoding;
}

}  // namespace

std::optional<Decoding> decode_profile(const ScanProfile& profile, const SymbolImage& start,
                                       const DecodeOptions& options) {
  constexpr std::size_t kLeastPlaces = 40;
  constexpr double kLeastGuards = 0.35;  // before any adjustment
  constexpr double kDecided = 20;        // logarithm of the likelihood ratio of the two ways up
  if (profile.size() < kLeastPlaces) return std::nullopt;
  if (explained_by_guards(profile, start) < kLeastGuards) return std::nullopt;
  const CharacterCosts costs = ModuleSystem(profile, start).character_costs();
  const double up = best_symbol(costs, SymbolClass::upright).cost;
  const double down = best_symbol(costs, SymbolClass::upside_down).cost;
  const double per_place = std::min(up, down) / static_cast<double>(profile.size());
  const double decided = 2 * kDecided * options.flattening * std::max(1.0, per_place);
  std::optional<Decoding> best;
  if (up < down + decided) best = decode_upright(profile, start, options);
  if (down < up + decided) {
    std::optional<Decoding> other = decode_upright(turned(profile), start, options);
    if (other && (!best || other->fit.explained > best->fit.explained)) {
      best = std::move(other);
      best->upside_down = true;
    }
  }
  return best;
}

}  // namespace tagsmith
