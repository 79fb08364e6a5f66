// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/decode.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "decoder/scan/explanation.hpp"
#include "decoder/scan/tuning.hpp"

namespace tagsmith::detail {
namespace {

// Other codes, and patterns that are no code at all.
PosteriorOdds doubt_about(const CharacterCosts& costs, const DecodeOptions& options,
                          const BestSymbol& best) {
  constexpr double kSymbols = 1e12;
  const auto besides = [](double sum) { return std::max(0.0, sum - 1); };
  PosteriorOdds doubt;
  if (!options.code_book.empty()) {
    const auto codes = static_cast<double>(options.code_book.size());
    doubt.other_codes = besides(sum_of_codes(costs, best, options.code_book));
    const double near =
        besides(sum_of_symbols(costs, best, {kOdds.near_stranger, kOdds.near_stranger}));
    const double any = kOdds.strangers * codes / kSymbols * sum_of_symbols(costs, best, {1, 0});
    doubt.misprints = near + any;
    return doubt;
  }
  for (const CheckDigit scheme : schemes_of(options)) {
    const bool holds = has_check_digit(scheme, digits_of(best.characters));
    const double sum = sum_of_codes(costs, best, scheme);
    doubt.other_codes += kOdds.understated * (holds ? besides(sum) : sum);
  }
  doubt.misprints = kOdds.understated * kOdds.wrong_check *
                    besides(sum_of_symbols(costs, best, {1, kOdds.foreign}));
  return doubt;
}

// The weight of the case that a digit only looks like this one: it counts as much as a code with
// another digit there may exist. With a single other digit no code is valid by the same scheme, one
// in nine is by the other scheme, and the rest are misprints. Where both schemes hold, neither does
// with any single other digit: both weigh each place by a factor with an inverse modulo 10.
double share_of_corrupted(const DecodeOptions& options, const Digits& digits) {
  constexpr double kOthers = 9;
  if (!options.code_book.empty()) return kOdds.corrupted_stranger;
  const bool both_hold =
      has_check_digit(CheckDigit::sum10, digits) && has_check_digit(CheckDigit::gs1, digits);
  if (options.check || both_hold) return kOdds.wrong_check;
  return (kOdds.understated + (kOthers - 1) * kOdds.wrong_check) / kOthers;
}

// The odds of the alternatives. When another code is likelier than the one that is read, its
// confidence becomes 0.
PosteriorOdds doubt_by(const ModuleNormalEquations& system, const DecodeOptions& options,
                       const Digits& digits) {
  const Characters characters = characters_of(digits);
  const CharacterCosts costs = system.character_costs(&characters);
  if (least_other_cost(costs, characters) > costs.of(characters) + kOdds.decided) return {};
  const BestSymbol best = best_of(costs, options);
  if (best.characters == characters) return doubt_about(costs, options, best);
  return kRefuted;
}

// The doubts about a decoding. It is not known whether the part that a digit leaves unexplained is
// noise there or belongs to another character, so the worse counts.
void judge(const ScanProfile& profile, const DecodeOptions& options, const Settled& settled,
           Decoding& decoding) {
  const ImagingModel& image = decoding.fit.image;
  const Characters characters = characters_of(decoding.digits);
  const VarianceFactors factors =
      variance_factors_of(settled.system.misfits(characters), all_modules());
  decoding.noise = factors.common;
  const std::vector<BarShare> bars = bar_shares(profile, image, decoding.digits);
  const auto system_of = [&](const ScanProfile& weighed) {
    return ModuleNormalEquations(weighed, settled.light, nuisance_covariance(weighed, image, bars));
  };
  const ModuleNormalEquations common = system_of(with_common_noise(profile, factors));
  decoding.doubt =
      doubt_by(system_of(with_local_noise(profile, factors)), options, decoding.digits);
  const PosteriorOdds other = doubt_by(common, options, decoding.digits);
  if (other.odds() > decoding.doubt.odds()) decoding.doubt = other;
  const auto corrupted = common.odds_of_corrupted_digits(characters);
  decoding.doubt.corrupted_digits = share_of_corrupted(options, decoding.digits) *
                                    std::accumulate(corrupted.begin(), corrupted.end(), 0.0);
  const double odds = decoding.doubt.odds();
  decoding.confidence = odds >= 0 ? 1 / (1 + odds) : 0;  // 0 also where it cannot be computed
}

// Decodes a profile seen the right way round.
std::optional<Decoding> decode_upright(const ScanProfile& profile, const DecodingStart& start,
                                       const DecodeOptions& options) {
  const std::optional<Explained> explained = explain(profile, start, options);
  if (!explained) return std::nullopt;
  Decoding decoding = explained->settled.decoding;
  if (decoding.fit.explained < kDecode.hopeless) {
    decoding.doubt = kRefuted;
    return decoding;
  }
  judge(profile, options, explained->settled, decoding);
  return decoding;
}

}  // namespace

std::optional<Decoding> decode_profile(const ScanProfile& profile, const ImagingModel& start,
                                       const DecodeOptions& options) {
  if (!shows_guards(profile, start)) return std::nullopt;
  const DecodingStart from(profile, start);
  const PossibleWays ways = possible_ways(profile, from.costs);
  std::optional<Decoding> best;
  if (ways.up) best = decode_upright(profile, from, options);
  if (ways.down) {
    const ScanProfile reversed = turned(profile);
    std::optional<Decoding> other =
        decode_upright(reversed, DecodingStart(reversed, start), options);
    if (other && (!best || other->fit.explained > best->fit.explained)) {
      best = other;
      best->upside_down = true;
    }
  }
  return best;
}

double log_odds_of_another(const ScanProfile& profile, const Decoding& decoding) {
  ScanProfile upright = decoding.upside_down ? turned(profile) : profile;
  for (ScanBin& bin : upright) bin.variance *= decoding.noise;
  const SymbolFit fit = fit_symbol(upright, decoding.digits, decoding.fit.image);
  const Characters digits = characters_of(decoding.digits);
  const CharacterCosts costs =
      ModuleNormalEquations(upright, ModuleLight(upright, fit.image)).character_costs(&digits);
  return (costs.of(digits) - best_symbol(costs, SymbolClass::any).cost) / 2;
}

}  // namespace tagsmith::detail
