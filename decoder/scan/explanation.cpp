// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/explanation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "decoder/scan/symbol_edges.hpp"
#include "decoder/scan/tuning.hpp"

namespace tagsmith::detail {

// ---- How well a symbol explains a profile.

namespace {

// Sums over one stretch of a profile.
struct Share {
  double variation = 0;  // about mid grey
  double unexplained = 0;
  double noise = 0;  // the part of the latter that the variances allow

  void add(const ScanBin& bin, double expected, double middle) {
    const double residual = bin.darkness - expected;
    const double deviation = bin.darkness - middle;
    unexplained += residual * residual / bin.variance;
    variation += deviation * deviation / bin.variance;
    noise += 1;
  }
};

// Whether a place is among guard patterns or beside them. Each left digit starts with a space and
// ends with a bar, each right digit the reverse.
bool is_known(double at) {
  constexpr std::array<std::array<double, 2>, 3> kKnown{{{-4, 4}, {44, 51}, {91, 99}}};
  return std::ranges::any_of(kKnown,
                             [&](const auto& range) { return at >= range[0] && at <= range[1]; });
}

}  // namespace

std::optional<std::size_t> digit_at(double place) {
  constexpr int kRight = first_module_of_digit(6);
  const int half = place < kRight ? 0 : 1;
  const int first = half == 0 ? first_module_of_digit(0) : kRight;
  const double digit = std::floor((place - first) / kModulesPerDigit);
  if (!(digit >= 0 && digit < 6)) return std::nullopt;
  return static_cast<std::size_t>(6 * half + static_cast<int>(digit));
}

std::vector<double> expected_darkness(const ImagingModel& image, const Digits& digits,
                                      const ScanProfile& profile) {
  const std::vector<float> shares = SymbolEdges(image, digits).shares_at(ScanPlaces(profile));
  std::vector<double> expected(profile.size());
  for (std::size_t i = 0; i < profile.size(); ++i) {
    expected[i] = image.white + (image.black - image.white) * static_cast<double>(shares[i]) +
                  image.shading * (2 * profile[i].at / kModuleCount - 1);
  }
  return expected;
}

double explained_by_guards(const ScanProfile& profile, const ImagingModel& image,
                           const std::vector<double>& expected) {
  const double middle = (image.white + image.black) / 2;
  Share share;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    if (is_known(profile[i].at)) share.add(profile[i], expected[i], middle);
  }
  return share.variation > 0 ? 1 - share.unexplained / share.variation : 0;
}

double guards_in(const ScanProfile& profile, const ImagingModel& image) {
  ScanProfile known;
  std::ranges::copy_if(profile, std::back_inserter(known), is_known, &ScanBin::at);
  return explained_by_guards(known, image, expected_darkness(image, {}, known));
}

bool shows_guards(const ScanProfile& profile, ImagingModel image) {
  if (guards_in(profile, image) >= kDecode.least_guards) return true;
  image.blur *= std::exp(kImaging.log_blur);
  return guards_in(profile, image) >= kDecode.least_guards;
}

std::array<double, kDigitCount> explained_by_digits(const ScanProfile& profile,
                                                    const ImagingModel& image,
                                                    const std::vector<double>& expected) {
  const double middle = (image.white + image.black) / 2;
  std::array<Share, kDigitCount> shares{};
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const auto digit = digit_at(profile[i].at);
    if (digit) shares[*digit].add(profile[i], expected[i], middle);
  }
  std::array<double, kDigitCount> explained{};
  std::ranges::transform(shares, explained.begin(), [](const Share& share) {
    if (share.variation <= 0) return 1.0;
    return 1 - std::max(0.0, share.unexplained - share.noise) / share.variation;
  });
  return explained;
}

// ---- What explains a profile best.

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
  BestSymbol best{{}, std::numeric_limits<double>::infinity()};
  for (const CheckDigit scheme : schemes_of(options)) {
    const BestSymbol found = best_code(costs, scheme);
    if (found.cost < best.cost) best = found;
  }
  return best;
}

namespace {

// Alternates between the most likely digits and the adjustment of the picture to them. `costs` are
// those of the profile with the start's picture.
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
    // What looks best as an even grey is no symbol, and other digits make it none.
    if (decoding.fit.is_grey || round == kDecode.rounds || is_settled()) {
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
