// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/decode_part.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

#include "decoder/scan/explanation.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// The part of a symbol that a profile shows. A digit is in sight where all of its modules are: the
// rest of another one cannot be distinguished from a digit that is smeared.
struct InSight {
  ModulesShown modules{};
  std::array<bool, kDigitCount> digits{};
};

void hide_digit(std::size_t digit, InSight& seen) {
  seen.digits[digit] = false;
  const auto first = seen.modules.begin() + first_module_of_digit(static_cast<int>(digit));
  std::fill(first, first + kModulesPerDigit, false);
}

InSight in_sight_of(const ScanProfile& profile) {
  InSight seen;
  for (int k = 0; k < kModuleCount; ++k) {
    seen.modules[static_cast<std::size_t>(k)] =
        profile.front().at <= k && k + 1 <= profile.back().at;
  }
  for (const ScanBin& bin : profile) {
    if (is_hidden(bin) && bin.at >= 0 && bin.at < kModuleCount)
      seen.modules[static_cast<std::size_t>(bin.at)] = false;
  }
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    const auto first = seen.modules.begin() + first_module_of_digit(static_cast<int>(i));
    seen.digits[i] = std::all_of(first, first + kModulesPerDigit, std::identity{});
    if (!seen.digits[i]) hide_digit(i, seen);
  }
  return seen;
}

// The profile without what is hidden and without the places of digits that it shows in part.
ScanProfile without_broken_digits(ScanProfile profile, const InSight& seen) {
  std::erase_if(profile, [&](const ScanBin& bin) {
    const bool is_outside = bin.at < 0 || bin.at >= kModuleCount;
    return is_hidden(bin) || (!is_outside && !seen.modules[static_cast<std::size_t>(bin.at)]);
  });
  return profile;
}

// A code with its digits out of sight taken from the reference.
Characters as_seen(const Digits& code, const Characters& reference,
                   const std::array<bool, kDigitCount>& in_sight) {
  Characters seen = reference;
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    if (in_sight[i]) seen[i] = code[i];
  }
  return seen;
}

// The costs when digits out of sight are the reference's.
CharacterCosts held_out_of_sight(CharacterCosts costs, const Characters& reference,
                                 const std::array<bool, kDigitCount>& in_sight) {
  constexpr double kNever = 1e6;
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    for (std::size_t c = 0; !in_sight[i] && c < kCharacterCount; ++c) {
      if (c != reference[i]) costs.alone[i][c] += kNever;
    }
  }
  return costs;
}

// Whether a digit of a part is the reference's.
enum class DigitVerdict { certain, uncertain, contradicted };
using DigitVerdicts = std::array<DigitVerdict, kDigitCount>;

// For some costs: each digit against all other characters in its place, or as it was judged before
// where that is worse. A digit is contradicted where the others together are likelier than if
// nothing of it were seen.
void judge_digits(const CharacterCosts& costs, const Characters& reference,
                  DigitVerdicts& verdicts) {
  const double own = costs.of(reference);
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    double others = -1;  // the digit itself
    Characters changed = reference;
    for (std::size_t c = 0; c < kCharacterCount; ++c) {
      changed[i] = static_cast<std::uint8_t>(c);
      others += std::exp((own - costs.of(changed)) / 2);
    }
    const DigitVerdict verdict = others > kCharacterCount ? DigitVerdict::contradicted
                                 : kOdds.near_stranger * others > kDecode.candidate
                                     ? DigitVerdict::uncertain
                                     : DigitVerdict::certain;
    verdicts[i] = std::max(verdicts[i], verdict);
  }
}

// The evidence against the digits that are certain, for some costs, and the odds of each code of
// the book against the reference by all digits in sight.
struct PartOdds {
  double misprints = 0;
  std::vector<double> codes;
};

PartOdds part_odds(const CharacterCosts& costs, const Characters& reference,
                   const DecodeOptions& options, const std::array<bool, kDigitCount>& in_sight,
                   const std::array<bool, kDigitCount>& certain) {
  const double own = costs.of(reference);
  PartOdds odds;
  for (const Digits& code : options.code_book) {
    const double other = costs.of(as_seen(code, reference, in_sight));
    odds.codes.push_back(std::exp((own - other) / 2));
  }
  const CharacterCosts held = held_out_of_sight(costs, reference, certain);
  const auto besides = [&](const CharacterWeights& weights) {
    return std::max(0.0, sum_of_symbols(held, {reference, own}, weights) - 1);
  };
  const double shown = static_cast<double>(std::ranges::count(certain, true));
  const double strangers =
      kOdds.strangers * static_cast<double>(options.code_book.size()) / std::pow(10, shown);
  odds.misprints =
      besides({kOdds.near_stranger, kOdds.near_stranger}) + strangers * besides({1, 0});
  return odds;
}

// The one of both that leaves more doubt.
PartOdds greater_of(PartOdds one, const PartOdds& other) {
  one.misprints = std::max(one.misprints, other.misprints);
  for (std::size_t i = 0; i < one.codes.size(); ++i) {
    one.codes[i] = std::max(one.codes[i], other.codes[i]);
  }
  return one;
}

// Makes the codes that cannot be excluded candidates; the others are doubt.
void list_candidates(const DecodeOptions& options, const PartOdds& odds, PartDecoding& part) {
  for (std::size_t i = 0; i < odds.codes.size(); ++i) {
    const bool is_listed = std::ranges::find(part.candidates, options.code_book[i],
                                             &PartCandidate::digits) != part.candidates.end();
    if (is_listed) continue;
    if (odds.codes[i] > kDecode.candidate) {
      part.candidates.push_back({options.code_book[i], odds.codes[i]});
    } else {
      part.decoding.doubt.other_codes += odds.codes[i];
    }
  }
  std::ranges::stable_sort(part.candidates, std::ranges::greater{}, &PartCandidate::odds);
}

// What the modules in sight of a part show, and how certain each digit is by that.
struct JudgedPart {
  PartDecoding part;
  DigitVerdicts verdicts{};
  std::array<double, kDigitCount> explained{};
};

std::optional<JudgedPart> judge_part(const ScanProfile& all, const InSight& seen,
                                     const ImagingModel& image, const DecodeOptions& options) {
  const ScanProfile profile = without_broken_digits(all, seen);
  if (profile.empty()) return std::nullopt;
  const std::optional<Explained> explained =
      explain(profile, DecodingStart(profile, image), options);
  if (!explained) return std::nullopt;
  const auto& [settled, of_digits] = *explained;
  JudgedPart judged{.part = {.decoding = settled.decoding, .certain = seen.digits},
                    .explained = of_digits};
  PartDecoding& part = judged.part;
  Decoding& decoding = part.decoding;
  if (decoding.fit.explained < kDecode.hopeless) {
    decoding.doubt = kRefuted;
    judged.verdicts.fill(DigitVerdict::contradicted);
    part.candidates.push_back({decoding.digits, 1});
    return judged;
  }
  const Characters digits = characters_of(decoding.digits);
  const VarianceFactors factors = variance_factors_of(settled.system.misfits(digits), seen.modules);
  decoding.noise = factors.common;
  const std::vector<BarShare> bars = bar_shares(profile, decoding.fit.image, decoding.digits);
  const auto system_of = [&](const ScanProfile& weighed) {
    return ModuleNormalEquations(weighed, settled.light,
                                 nuisance_covariance(weighed, decoding.fit.image, bars));
  };
  // By both estimates of the noise, using the one that leaves more doubt.
  const CharacterCosts local =
      system_of(with_local_noise(profile, factors)).character_costs(&digits);
  const ModuleNormalEquations evenly_noisy = system_of(with_common_noise(profile, factors));
  const CharacterCosts common = evenly_noisy.character_costs(&digits);
  for (const CharacterCosts* costs : {&local, &common}) {
    judge_digits(*costs, digits, judged.verdicts);
  }
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    if (judged.verdicts[i] == DigitVerdict::uncertain) part.certain[i] = false;
  }
  const PartOdds odds = greater_of(part_odds(local, digits, options, seen.digits, part.certain),
                                   part_odds(common, digits, options, seen.digits, part.certain));
  decoding.doubt.misprints = odds.misprints;
  list_candidates(options, odds, part);
  const auto corrupted = evenly_noisy.odds_of_corrupted_digits(digits);
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    if (part.certain[i]) {
      decoding.doubt.corrupted_digits += kOdds.corrupted_stranger * corrupted[i];
    }
  }
  const double doubt = decoding.doubt.odds();
  decoding.confidence = doubt >= 0 ? 1 / (1 + doubt) : 0;
  decoding.digits = part.candidates.front().digits;
  return judged;
}

// Takes digits out of sight that are disturbed: those that nothing contradicts, although they are
// explained badly or are not certain. Returns whether there are any.
bool hide_disturbed(const JudgedPart& judged, InSight& seen) {
  bool any = false;
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    const bool is_disturbed =
        judged.verdicts[i] == DigitVerdict::uncertain ||
        (judged.verdicts[i] == DigitVerdict::certain && judged.explained[i] < kDecode.hopeless);
    if (!seen.digits[i] || !is_disturbed) continue;
    hide_digit(i, seen);
    any = true;
  }
  return any;
}

// As decode_upright, for a part: the visible modules of a disturbed digit would disturb the others.
// Why: docs/decisions/0005-parts-and-frameless-symbols.md.
std::optional<PartDecoding> decode_part_upright(const ScanProfile& all, const ImagingModel& image,
                                                const DecodeOptions& options) {
  InSight seen = in_sight_of(all);
  std::optional<JudgedPart> judged = judge_part(all, seen, image, options);
  while (judged && hide_disturbed(*judged, seen)) {
    auto next = judge_part(all, seen, image, options);
    if (!next) break;
    judged = std::move(next);
  }
  return judged ? std::optional(std::move(judged->part)) : std::nullopt;
}

}  // namespace

std::optional<PartDecoding> decode_part(const ScanProfile& profile, const ImagingModel& start,
                                        const DecodeOptions& options) {
  if (options.code_book.empty()) return std::nullopt;
  if (!shows_guards(profile, start)) return std::nullopt;
  const PossibleWays ways = possible_ways(profile, DecodingStart(profile, start).costs);
  std::optional<PartDecoding> best;
  if (ways.up) best = decode_part_upright(profile, start, options);
  if (!ways.down) return best;
  auto other = decode_part_upright(turned(profile), start, options);
  if (!other) return best;
  if (best && best->decoding.fit.explained >= other->decoding.fit.explained) return best;
  other->decoding.upside_down = true;
  return other;
}

}  // namespace tagsmith::detail
