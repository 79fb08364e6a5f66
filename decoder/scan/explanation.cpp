// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/explanation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "decoder/scan/explained.hpp"
#include "decoder/scan/tuning.hpp"

namespace tagsmith::detail {

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

Digits digits_of(const Characters& characters) {
  Digits digits{};
  std::ranges::copy(characters, digits.begin());
  return digits;
}

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

namespace {

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
    if (!(image.black > image.white)) return std::nullopt;
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
      return Settled{decoding, std::move(light), std::move(system)};
    }
  }
}

}  // namespace

std::optional<Explained> explain(const ScanProfile& profile, const DecodingStart& start,
                                 const DecodeOptions& options) {
  std::optional<Settled> settled = settle(profile, start.image, start.costs, options);
  if (!settled) return std::nullopt;
  Decoding& decoding = settled->decoding;
  const std::vector<double> expected =
      expected_darkness(decoding.fit.image, decoding.digits, profile);
  decoding.guards = explained_by_guards(profile, decoding.fit.image, expected);
  const auto digits = explained_by_digits(profile, decoding.fit.image, expected);
  decoding.worst_digit = *std::ranges::min_element(digits);
  return Explained{*std::move(settled), digits};
}

PossibleWays possible_ways(const ScanProfile& profile, const CharacterCosts& costs) {
  const double up = best_symbol(costs, SymbolClass::upright).cost;
  const double down = best_symbol(costs, SymbolClass::upside_down).cost;
  const double per_place = std::min(up, down) / static_cast<double>(profile.size());
  const double decided = kOdds.decided * std::max(1.0, per_place);
  return {up < down + decided, down < up + decided};
}

VarianceFactors variance_factors_of(const std::array<float, kModuleCount>& misfits,
                                    const ModulesShown& shown) {
  constexpr double kClearMean = 0.44;  // of a chi-square variable of one degree below its 80 %
  std::vector<float> sorted;
  for (std::size_t k = 0; k < misfits.size(); ++k) {
    if (shown[k]) sorted.push_back(misfits[k]);
  }
  const std::size_t clear = sorted.size() * 8 / 10;  // fit best
  std::ranges::sort(sorted);
  double sum = 0;
  for (std::size_t k = 0; k < clear; ++k) sum += static_cast<double>(sorted[k]);
  VarianceFactors factors;
  factors.common = std::max(kDecode.least_noise, sum / static_cast<double>(clear) / kClearMean);
  for (int k = 0; k < kModuleCount; ++k) {
    double weight = kDecode.noise_prior;
    double total = kDecode.noise_prior * factors.common;
    for (int near = std::max(0, k - kNearModules);
         near <= std::min(kModuleCount - 1, k + kNearModules); ++near) {
      if (!shown[static_cast<std::size_t>(near)]) continue;
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

}  // namespace tagsmith::detail
