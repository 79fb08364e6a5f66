// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/decode.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "decoder/scan/character_costs.hpp"
#include "decoder/scan/explained.hpp"
#include "decoder/scan/module_equations.hpp"
#include "decoder/scan/module_light.hpp"
#include "decoder/scan/symbol_search.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {

ScanProfile turned(const ScanProfile& profile) {
  ScanProfile result(profile.rbegin(), profile.rend());
  for (ScanBin& bin : result) bin.at = kModuleCount - bin.at;
  return result;
}

namespace {

Digits digits_of(const Characters& characters) {
  Digits digits{};
  std::ranges::copy(characters, digits.begin());
  return digits;
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

// Other codes, and what is no code at all.
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

// Modules of a symbol that a profile shows wholly.
struct ModuleRange {
  int begin = 0;
  int end = kModuleCount;
};

// By how much the profile's variances fall short of what the symbol leaves unexplained: about each
// module, and in most of the symbol. What dirt or light leave in one place must not count for all
// of it, nor be lost in all of it.
struct VarianceFactors {
  std::array<double, kModuleCount> local{};
  double common = 0;
};

// From the misfits of the profile to the modules that it shows.
VarianceFactors variance_factors_of(const std::array<float, kModuleCount>& misfits,
                                    const ModuleRange& shown) {
  const auto clear = static_cast<std::size_t>((shown.end - shown.begin) * 8 / 10);  // fit best
  constexpr double kClearMean = 0.44;  // of a chi-square variable of one degree below its 80 %
  std::vector<float> sorted(misfits.begin() + shown.begin, misfits.begin() + shown.end);
  std::ranges::sort(sorted);
  double sum = 0;
  for (std::size_t k = 0; k < clear; ++k) sum += static_cast<double>(sorted[k]);
  VarianceFactors factors;
  factors.common = std::max(kDecode.least_noise, sum / static_cast<double>(clear) / kClearMean);
  for (int k = 0; k < kModuleCount; ++k) {
    double weight = kDecode.noise_prior;
    double total = kDecode.noise_prior * factors.common;
    for (int near = std::max(shown.begin, k - kDecode.noise_reach);
         near <= std::min(shown.end - 1, k + kDecode.noise_reach); ++near) {
      total += static_cast<double>(misfits[static_cast<std::size_t>(near)]);
      weight += 1;
    }
    factors.local[static_cast<std::size_t>(k)] = total / weight;
  }
  return factors;
}

ScanProfile with_local_noise(ScanProfile profile, const VarianceFactors& factors) {
  for (ScanBin& bin : profile) {
    const int module = std::clamp(static_cast<int>(std::floor(bin.at)), 0, kModuleCount - 1);
    bin.variance *= factors.local[static_cast<std::size_t>(module)];
  }
  return profile;
}

ScanProfile with_common_noise(ScanProfile profile, const VarianceFactors& factors) {
  for (ScanBin& bin : profile) bin.variance *= factors.common;
  return profile;
}

// The share of digits that only look like these: with a single other digit the code would be
// another scheme's, a misprint or a stranger. Where both schemes hold, neither does with any single
// other digit: both weigh each place by what has an inverse modulo 10.
double share_of_corrupted(const DecodeOptions& options, const Digits& digits) {
  if (!options.code_book.empty()) return kOdds.corrupted_stranger;
  const bool may_be_others = !options.check && !(has_check_digit(CheckDigit::sum10, digits) &&
                                                 has_check_digit(CheckDigit::gs1, digits));
  return kOdds.wrong_check + (may_be_others ? 1 : 0);
}

// How a profile is read at first: by the picture of the symbol that it starts from.
struct Start {
  explicit Start(const ScanProfile& profile, const ImagingModel& picture)
      : image(picture),
        light(profile, picture),
        costs(ModuleNormalEquations(profile, light).character_costs()) {}

  ImagingModel image;
  ModuleLight light;
  CharacterCosts costs;
};

// Digits and a picture that fit each other, and what that was found by.
struct Settled {
  Decoding decoding;
  ModuleLight light;             // by the picture of the decoding
  ModuleNormalEquations system;  // of the profile, by that light
};

// Alternates between the most likely digits and the adjustment of the picture to them. `costs` are
// those of the profile by the start's picture.
std::optional<Settled> settle(const ScanProfile& profile, const ImagingModel& start,
                              const CharacterCosts& costs, const DecodeOptions& options) {
  Decoding decoding;
  decoding.digits = digits_of(best_of(costs, options).characters);
  double blur = start.blur;
  for (int round = 1;; ++round) {
    ImagingModel from = start;
    from.blur = blur;
    decoding.fit = fit_symbol(profile, decoding.digits, from);
    const ImagingModel& image = decoding.fit.image;
    if (!(image.black - image.white > kSymbolFit.least_contrast)) return std::nullopt;
    blur = image.blur;
    ModuleLight light(profile, image);
    ModuleNormalEquations system(profile, light);
    const Characters reference = characters_of(decoding.digits);
    const auto is_settled = [&] {
      const Digits digits =
          digits_of(best_of(system.character_costs(&reference), options).characters);
      return std::exchange(decoding.digits, digits) == digits;
    };
    if (round == kDecode.rounds || is_settled()) {
      return Settled{std::move(decoding), std::move(light), std::move(system)};
    }
  }
}

// The profile with the places that the symbol cannot explain given almost no weight, and the share
// of places that keep theirs. Only places where the bars' height disagrees with itself may be set
// aside: dirt, glare and cables have outlines, whereas a bar that is not ours looks alike all
// along.
struct Cleaned {
  ScanProfile profile;
  double kept = 1;
};

// Why: docs/decisions/0004-occlusion.md.
Cleaned set_aside_outliers(const ScanProfile& profile, const Decoding& decoding) {
  Cleaned cleaned{profile, 1};
  std::size_t covered = 0;
  const ImagingModel& image = decoding.fit.image;
  const std::vector<double> expected = expected_darkness(image, decoding.digits, profile);
  for (std::size_t i = 0; i < profile.size(); ++i) {
    if (profile[i].agreement > kDecode.agreement) continue;
    const double residual = std::abs(profile[i].darkness - expected[i]);
    const double contrast = image.black - image.white;
    if (residual < kDecode.odd * contrast + kDecode.odd_sigmas * std::sqrt(profile[i].variance))
      continue;
    cleaned.profile[i].variance = kHiddenVariance;
    ++covered;
  }
  cleaned.kept = 1 - static_cast<double>(covered) / static_cast<double>(profile.size());
  return cleaned;
}

// Nothing is left of the digits.
constexpr PosteriorOdds kRefuted{std::numeric_limits<double>::infinity(), 0, 0};

// What else could be there. When another code is likelier than the one that is read, nothing is
// left of it.
PosteriorOdds doubt_by(const ModuleNormalEquations& system, const DecodeOptions& options,
                       const Digits& digits) {
  const Characters characters = characters_of(digits);
  const CharacterCosts costs = system.character_costs(&characters);
  if (least_other_cost(costs, characters) > costs.of(characters) + kOdds.decided) return {};
  const BestSymbol best = best_of(costs, options);
  if (best.characters == characters) return doubt_about(costs, options, best);
  return kRefuted;
}

// What is to be doubted about a decoding. What was set aside is left out of the likelihoods, but
// counts for the noise about it: a place that is covered in part says little. Whether what a digit
// leaves unexplained is noise there or belongs to another character is not known, so the worse
// counts.
void judge(const ScanProfile& profile, const ScanProfile& cleaned, const DecodeOptions& options,
           const Settled& settled, Decoding& decoding) {
  const ImagingModel& image = decoding.fit.image;
  const Characters characters = characters_of(decoding.digits);
  const bool is_whole = decoding.fit.kept == 1;
  const VarianceFactors factors = variance_factors_of(
      is_whole ? settled.system.misfits(characters)
               : ModuleNormalEquations(profile, settled.light).misfits(characters),
      {});
  decoding.noise = factors.common;
  const std::vector<BarShare> bars = bar_shares(profile, image, decoding.digits);
  const auto system_of = [&](const ScanProfile& weighed) {
    return ModuleNormalEquations(weighed, settled.light, nuisance_covariance(weighed, image, bars));
  };
  const ModuleNormalEquations common = system_of(with_common_noise(cleaned, factors));
  decoding.doubt =
      doubt_by(system_of(with_local_noise(cleaned, factors)), options, decoding.digits);
  const PosteriorOdds other = doubt_by(common, options, decoding.digits);
  if (other.odds() > decoding.doubt.odds()) decoding.doubt = other;
  const auto corrupted =
      is_whole
          ? common.odds_of_corrupted_digits(characters)
          : system_of(with_common_noise(profile, factors)).odds_of_corrupted_digits(characters);
  decoding.doubt.corrupted_digits = share_of_corrupted(options, decoding.digits) *
                                    std::accumulate(corrupted.begin(), corrupted.end(), 0.0);
  const double odds = decoding.doubt.odds();
  decoding.confidence = odds >= 0 ? 1 / (1 + odds) : 0;  // 0 also where nothing can be computed
}

// What explains a profile seen the right way round, not yet judged.
struct Explained {
  Cleaned cleaned;
  Settled settled;
};

std::optional<Explained> explain(const ScanProfile& profile, const Start& start,
                                 const DecodeOptions& options) {
  std::optional<Settled> settled = settle(profile, start.image, start.costs, options);
  Cleaned cleaned{profile, 1};
  for (int i = 0;
       settled && i < kDecode.cleanings && settled->decoding.fit.explained < kDecode.clean; ++i) {
    Cleaned next = set_aside_outliers(profile, settled->decoding);
    if (next.kept == cleaned.kept) break;
    cleaned = std::move(next);
    settled =
        settle(cleaned.profile, start.image,
               ModuleNormalEquations(cleaned.profile, start.light).character_costs(), options);
  }
  if (!settled) return std::nullopt;
  Decoding& decoding = settled->decoding;
  decoding.fit.kept = cleaned.kept;
  const std::vector<double> expected =
      expected_darkness(decoding.fit.image, decoding.digits, profile);
  decoding.guards = explained_by_guards(cleaned.profile, decoding.fit.image, expected);
  decoding.worst_digit = least_explained_digit(cleaned.profile, decoding.fit.image, expected);
  return Explained{std::move(cleaned), *std::move(settled)};
}

// Decodes a profile seen the right way round.
std::optional<Decoding> decode_upright(const ScanProfile& profile, const Start& start,
                                       const DecodeOptions& options) {
  const std::optional<Explained> explained = explain(profile, start, options);
  if (!explained) return std::nullopt;
  Decoding decoding = explained->settled.decoding;
  if (decoding.fit.explained < kDecode.hopeless) {
    decoding.doubt = kRefuted;
    return decoding;
  }
  judge(profile, explained->cleaned.profile, options, explained->settled, decoding);
  return decoding;
}

}  // namespace

std::optional<Decoding> decode_profile(const ScanProfile& profile, const ImagingModel& start,
                                       const DecodeOptions& options) {
  if (profile.size() < kDecode.least_places) return std::nullopt;
  if (guards_in(profile, start) < kDecode.least_guards) return std::nullopt;
  const Start from(profile, start);
  const double up = best_symbol(from.costs, SymbolClass::upright).cost;
  const double down = best_symbol(from.costs, SymbolClass::upside_down).cost;
  const double per_place = std::min(up, down) / static_cast<double>(profile.size());
  const double decided = kOdds.decided * std::max(1.0, per_place);
  std::optional<Decoding> best;
  if (up < down + decided) best = decode_upright(profile, from, options);
  if (down < up + decided) {
    const ScanProfile reversed = turned(profile);
    std::optional<Decoding> other = decode_upright(reversed, Start(reversed, start), options);
    if (other && (!best || other->fit.explained > best->fit.explained)) {
      best = std::move(other);
      best->upside_down = true;
    }
  }
  return best;
}

namespace {

// The modules that a profile shows, to half a module.
ModuleRange modules_in_sight(const ScanProfile& profile) {
  const auto module = [](double at) {
    return std::clamp(static_cast<int>(std::lround(at)), 0, kModuleCount);
  };
  return {module(profile.front().at), module(profile.back().at)};
}

// The digits of which a profile shows all modules.
std::array<bool, kDigitCount> digits_in_sight(const ScanProfile& profile) {
  const ModuleRange shown = modules_in_sight(profile);
  std::array<bool, kDigitCount> in_sight{};
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    const int first = first_module_of_digit(static_cast<int>(i));
    in_sight[i] = shown.begin <= first && first + kModulesPerDigit <= shown.end;
  }
  return in_sight;
}

// The profile without the places of digits that it shows in part: what is left of such a digit
// cannot be told from another one that is smeared.
ScanProfile without_broken_digits(ScanProfile profile) {
  double begin = profile.front().at, end = profile.back().at;
  const double first = begin, last = end;
  for (int i = 0; i < static_cast<int>(kDigitCount); ++i) {
    const double from = first_module_of_digit(i), to = from + kModulesPerDigit;
    if (from < first && first < to) begin = to;
    if (from < last && last < to) end = from;
  }
  std::erase_if(profile, [&](const ScanBin& bin) { return bin.at < begin || bin.at > end; });
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

// What speaks against the digits in sight by some costs, and the odds of each code of the book
// against the reference.
struct PartOdds {
  double misprints = 0;
  std::vector<double> codes;
};

PartOdds part_odds(const CharacterCosts& costs, const Characters& reference,
                   const DecodeOptions& options, const std::array<bool, kDigitCount>& in_sight) {
  const double own = costs.of(reference);
  PartOdds odds;
  for (const Digits& code : options.code_book) {
    const double other = costs.of(as_seen(code, reference, in_sight));
    odds.codes.push_back(std::exp((own - other) / 2));
  }
  const CharacterCosts held = held_out_of_sight(costs, reference, in_sight);
  const auto besides = [&](const CharacterWeights& weights) {
    return std::max(0.0, sum_of_symbols(held, {reference, own}, weights) - 1);
  };
  const double shown = static_cast<double>(std::ranges::count(in_sight, true));
  const double strangers =
      kOdds.strangers * static_cast<double>(options.code_book.size()) / std::pow(10, shown);
  odds.misprints =
      besides({kOdds.near_stranger, kOdds.near_stranger}) + strangers * besides({1, 0});
  return odds;
}

// Takes the codes that cannot be ruled out for candidates; the others are doubt.
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

// As decode_upright, of a part. Why: docs/decisions/0025-parts-of-tags.md.
std::optional<PartDecoding> decode_part_upright(const ScanProfile& all, const ImagingModel& image,
                                                const DecodeOptions& options) {
  const ScanProfile profile = without_broken_digits(all);
  if (profile.size() < kDecode.least_places) return std::nullopt;
  const std::optional<Explained> explained = explain(profile, Start(profile, image), options);
  if (!explained) return std::nullopt;
  const auto& [cleaned, settled] = *explained;
  PartDecoding part{.decoding = settled.decoding, .in_sight = digits_in_sight(profile)};
  Decoding& decoding = part.decoding;
  if (decoding.fit.explained < kDecode.hopeless) {
    decoding.doubt = kRefuted;
    part.candidates.push_back({decoding.digits, 1});
    return part;
  }
  const Characters digits = characters_of(decoding.digits);
  const VarianceFactors factors = variance_factors_of(
      ModuleNormalEquations(profile, settled.light).misfits(digits), modules_in_sight(profile));
  decoding.noise = factors.common;
  const std::vector<BarShare> bars = bar_shares(profile, decoding.fit.image, decoding.digits);
  const auto system_of = [&](const ScanProfile& weighed) {
    return ModuleNormalEquations(weighed, settled.light,
                                 nuisance_covariance(weighed, decoding.fit.image, bars));
  };
  // By both estimates of the noise, whichever leaves more doubt.
  PartOdds odds =
      part_odds(system_of(with_local_noise(cleaned.profile, factors)).character_costs(&digits),
                digits, options, part.in_sight);
  const PartOdds other =
      part_odds(system_of(with_common_noise(cleaned.profile, factors)).character_costs(&digits),
                digits, options, part.in_sight);
  decoding.doubt.misprints = std::max(odds.misprints, other.misprints);
  for (std::size_t i = 0; i < odds.codes.size(); ++i) {
    odds.codes[i] = std::max(odds.codes[i], other.codes[i]);
  }
  list_candidates(options, odds, part);
  const auto corrupted =
      system_of(with_common_noise(profile, factors)).odds_of_corrupted_digits(digits);
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    if (part.in_sight[i]) {
      decoding.doubt.corrupted_digits += kOdds.corrupted_stranger * corrupted[i];
    }
  }
  const double doubt = decoding.doubt.odds();
  decoding.confidence = doubt >= 0 ? 1 / (1 + doubt) : 0;
  decoding.digits = part.candidates.front().digits;
  return part;
}

}  // namespace

std::optional<PartDecoding> decode_part(const ScanProfile& profile, const ImagingModel& start,
                                        const DecodeOptions& options) {
  if (profile.size() < kDecode.least_places || options.code_book.empty()) return std::nullopt;
  if (guards_in(profile, start) < kDecode.least_guards) return std::nullopt;
  const CharacterCosts costs = Start(profile, start).costs;
  const double up = best_symbol(costs, SymbolClass::upright).cost;
  const double down = best_symbol(costs, SymbolClass::upside_down).cost;
  const double per_place = std::min(up, down) / static_cast<double>(profile.size());
  const double decided = kOdds.decided * std::max(1.0, per_place);
  std::optional<PartDecoding> best;
  if (up < down + decided) best = decode_part_upright(profile, start, options);
  if (!(down < up + decided)) return best;
  auto other = decode_part_upright(turned(profile), start, options);
  if (!other) return best;
  if (best && best->decoding.fit.explained >= other->decoding.fit.explained) return best;
  other->decoding.upside_down = true;
  return other;
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
