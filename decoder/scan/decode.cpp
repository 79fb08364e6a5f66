// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/decode.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tagsmith/base/normal.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

constexpr double kHalfLength = kModuleCount / 2.0;
constexpr std::size_t kDigits = kDigitCount;

using DigitCosts = std::array<double, 10>;
using PairCosts = std::array<std::array<double, 10>, 10>;

// The sum of squared residuals of a symbol is a constant plus a term for each digit and one for
// each pair of neighbours, because light adds up and blur reaches no farther than the next digit.
struct CostTable {
  std::array<DigitCosts, kDigits> alone{};
  std::array<PairCosts, kDigits - 1> pair{};
  double constant = 0;
};

double displaced(const SymbolImage& image, double at) {
  const double t = (at - kHalfLength) / kHalfLength;
  return at + image.shift + image.stretch * (at - kHalfLength) + image.bend * t * t;
}

// Share of the light at `place` that a bar between two nominal edges takes.
double bar_share(const SymbolImage& image, double begin, double end, double place) {
  const double b = displaced(image, begin) - image.growth / 2;
  const double e = displaced(image, end) + image.growth / 2;
  return normal_integral((place - b) / image.blur) - normal_integral((place - e) / image.blur);
}

// Bars of a digit, as nominal begins and ends: two of them.
std::array<std::array<double, 2>, 2> bars_of_digit(int position, std::size_t digit) {
  const auto& widths = kDigitElements[digit];
  const double start = first_module_of_digit(position);
  const double a = widths[0];
  const double b = a + widths[1];
  const double c = b + widths[2];
  if (position < 6) return {{{start + a, start + b}, {start + c, start + kModulesPerDigit}}};
  return {{{start, start + a}, {start + b, start + c}}};
}

// A digit's bars over the stretch of the profile that they reach.
struct DigitShape {
  std::size_t begin = 0;  // index into the profile
  std::vector<std::array<double, 10>> share;
};

DigitShape shape_of(const ScanProfile& profile, const SymbolImage& image, int position) {
  const double reach = 4 * image.blur + std::abs(image.growth);
  const double low = displaced(image, first_module_of_digit(position)) - reach;
  const double high = displaced(image, first_module_of_digit(position) + kModulesPerDigit) + reach;
  const auto before = [](const ScanBin& bin, double at) { return bin.at < at; };
  const auto first = std::lower_bound(profile.begin(), profile.end(), low, before);
  const auto last = std::lower_bound(first, profile.end(), high, before);
  DigitShape shape;
  shape.begin = static_cast<std::size_t>(first - profile.begin());
  shape.share.resize(static_cast<std::size_t>(last - first));
  for (std::size_t digit = 0; digit < 10; ++digit) {
    const auto bars = bars_of_digit(position, digit);
    for (std::size_t i = 0; i < shape.share.size(); ++i) {
      const double place = profile[shape.begin + i].at;
      shape.share[i][digit] = bar_share(image, bars[0][0], bars[0][1], place) +
                              bar_share(image, bars[1][0], bars[1][1], place);
    }
  }
  return shape;
}

// The profile without levels, shading and guard patterns, in units of the contrast.
std::vector<double> remainder_of(const ScanProfile& profile, const SymbolImage& image) {
  constexpr std::array<std::array<double, 2>, 6> kGuardBars{
      {{0, 1}, {2, 3}, {46, 47}, {48, 49}, {92, 93}, {94, 95}}};
  std::vector<double> remainder;
  remainder.reserve(profile.size());
  const double contrast = image.black - image.white;
  for (const ScanBin& bin : profile) {
    const double t = (bin.at - kHalfLength) / kHalfLength;
    double rest = (bin.darkness - image.white - image.shading * t) / contrast;
    for (const auto& bar : kGuardBars) rest -= bar_share(image, bar[0], bar[1], bin.at);
    remainder.push_back(rest);
  }
  return remainder;
}

void add_pair_costs(const DigitShape& left, const DigitShape& right,
                    const std::vector<double>& weights, PairCosts& costs) {
  const std::size_t begin = std::max(left.begin, right.begin);
  const std::size_t end =
      std::min(left.begin + left.share.size(), right.begin + right.share.size());
  for (std::size_t i = begin; i < end; ++i) {
    const auto& a = left.share[i - left.begin];
    const auto& b = right.share[i - right.begin];
    for (std::size_t j = 0; j < 10; ++j) {
      const double twice = 2 * weights[i] * a[j];
      for (std::size_t k = 0; k < 10; ++k) costs[j][k] += twice * b[k];
    }
  }
}

CostTable cost_table(const ScanProfile& profile, const SymbolImage& image) {
  const std::vector<double> remainder = remainder_of(profile, image);
  const double contrast = image.black - image.white;
  std::vector<double> weights;
  weights.reserve(profile.size());
  for (const ScanBin& bin : profile) weights.push_back(contrast * contrast / bin.variance);
  CostTable table;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    table.constant += weights[i] * remainder[i] * remainder[i];
  }
  std::array<DigitShape, kDigits> shapes;
  for (std::size_t position = 0; position < kDigits; ++position) {
    const DigitShape& shape = shapes[position] =
        shape_of(profile, image, static_cast<int>(position));
    for (std::size_t i = 0; i < shape.share.size(); ++i) {
      const std::size_t bin = shape.begin + i;
      for (std::size_t digit = 0; digit < 10; ++digit) {
        const double share = shape.share[i][digit];
        table.alone[position][digit] += weights[bin] * share * (share - 2 * remainder[bin]);
      }
    }
    if (position > 0) {
      add_pair_costs(shapes[position - 1], shape, weights, table.pair[position - 1]);
    }
  }
  return table;
}

double cost_of(const CostTable& table, const Digits& digits) {
  double cost = table.constant + table.alone[0][digits[0]];
  for (std::size_t i = 1; i < kDigits; ++i) {
    cost += table.alone[i][digits[i]] + table.pair[i - 1][digits[i - 1]][digits[i]];
  }
  return cost;
}

// How much a digit adds to the check sum at a position, so that valid symbols sum to 0 modulo 10.
int check_term(CheckDigit scheme, std::size_t position, std::size_t digit) {
  const int value = static_cast<int>(digit);
  if (scheme == CheckDigit::gs1) return (position % 2 == 0 ? 3 : 1) * value % 10;
  return position + 1 == kDigits ? (10 - value) % 10 : value;
}

// The most likely symbol of a set, and how likely the set is together.
struct Search {
  Digits best{};
  double best_cost = std::numeric_limits<double>::infinity();
  double log_sum = -std::numeric_limits<double>::infinity();  // of exp(-cost / (2 * temperature))
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The symbols that end, so far, in one digit with one check sum.
struct Cell {
  double cost = kInfinity;      // of the best of them
  double mass = 0;              // summed likelihoods relative to exp(-cost / (2 temperature))
  std::uint8_t from_digit = 0;  // where the best came from
  std::uint8_t from_sum = 0;
};

using Layer = std::array<std::array<Cell, 10>, 10>;  // [check sum][digit]
using Trellis = std::array<Layer, kDigits>;

// What a digit adds to the check sum; without a scheme all sums are 0.
std::size_t sum_term(std::optional<CheckDigit> scheme, std::size_t position, std::size_t digit) {
  return scheme ? static_cast<std::size_t>(check_term(*scheme, position, digit)) : 0;
}

// The cell of `digit` reached from the cells of one check sum: `row[previous]`, with `pair` costs.
Cell extend(const std::array<Cell, 10>& row, const PairCosts& pair, std::size_t digit,
            std::size_t sum, double temperature) {
  Cell cell;
  for (std::size_t previous = 0; previous < 10; ++previous) {
    const double cost = row[previous].cost + pair[previous][digit];
    if (cost >= cell.cost) continue;
    cell = {cost, 0, static_cast<std::uint8_t>(previous), static_cast<std::uint8_t>(sum)};
  }
  if (cell.cost == kInfinity) return cell;
  for (std::size_t previous = 0; previous < 10; ++previous) {
    if (row[previous].cost == kInfinity) continue;
    const double excess = row[previous].cost + pair[previous][digit] - cell.cost;
    cell.mass += row[previous].mass * std::exp(-excess / (2 * temperature));
  }
  return cell;
}

Trellis fill_trellis(const CostTable& table, std::optional<CheckDigit> scheme, double temperature) {
  const std::size_t sums = scheme ? 10 : 1;
  Trellis trellis{};
  for (std::size_t digit = 0; digit < 10; ++digit) {
    trellis[0][sum_term(scheme, 0, digit)][digit] = {table.constant + table.alone[0][digit], 1};
  }
  for (std::size_t position = 1; position < kDigits; ++position) {
    for (std::size_t sum = 0; sum < sums; ++sum) {
      for (std::size_t digit = 0; digit < 10; ++digit) {
        const std::size_t next = (sum + sum_term(scheme, position, digit)) % sums;
        Cell& cell = trellis[position][next][digit];
        cell =
            extend(trellis[position - 1][sum], table.pair[position - 1], digit, sum, temperature);
        cell.cost += table.alone[position][digit];
      }
    }
  }
  return trellis;
}

// The digits on the way to the best cell of the last layer.
Digits trace(const Trellis& trellis, std::size_t last_digit) {
  Digits digits{};
  std::size_t digit = last_digit;
  std::size_t sum = 0;
  for (std::size_t position = kDigits; position-- > 0;) {
    digits[position] = static_cast<std::uint8_t>(digit);
    const Cell& cell = trellis[position][sum][digit];
    digit = cell.from_digit;
    sum = cell.from_sum;
  }
  return digits;
}

// Over the symbols whose check sum is 0 under the scheme; without a scheme over all 10^12.
Search search(const CostTable& table, std::optional<CheckDigit> scheme, double temperature) {
  const Trellis trellis = fill_trellis(table, scheme, temperature);
  const std::array<Cell, 10>& ends = trellis[kDigits - 1][0];
  const auto best = std::ranges::min_element(ends, {}, &Cell::cost);
  double mass = 0;
  for (const Cell& cell : ends) {
    if (cell.cost == kInfinity) continue;
    mass += cell.mass * std::exp((best->cost - cell.cost) / (2 * temperature));
  }
  Search found;
  found.best_cost = best->cost;
  found.best = trace(trellis, static_cast<std::size_t>(best - ends.begin()));
  found.log_sum = std::log(mass) - best->cost / (2 * temperature);
  return found;
}

Search search_book(const CostTable& table, std::span<const Digits> book, double temperature) {
  Search found;
  std::vector<double> costs;
  costs.reserve(book.size());
  for (const Digits& digits : book) {
    costs.push_back(cost_of(table, digits));
    if (costs.back() >= found.best_cost) continue;
    found.best_cost = costs.back();
    found.best = digits;
  }
  double mass = 0;
  for (const double cost : costs) mass += std::exp((found.best_cost - cost) / (2 * temperature));
  found.log_sum = std::log(mass) - found.best_cost / (2 * temperature);
  return found;
}

std::vector<CheckDigit> schemes_of(const DecodeOptions& options) {
  if (options.check) return {*options.check};
  return {CheckDigit::sum10, CheckDigit::gs1};
}

// The most likely code among those that may exist.
Search best_code(const CostTable& table, const DecodeOptions& options, double temperature) {
  if (!options.code_book.empty()) return search_book(table, options.code_book, temperature);
  Search best;
  for (const CheckDigit scheme : schemes_of(options)) {
    const Search found = search(table, scheme, temperature);
    if (found.best_cost >= best.best_cost) continue;
    best = found;
  }
  return best;
}

// Summed likelihoods of the search's codes except `code`, relative to the likelihood of `code`.
double others(const Search& found, bool holds_code, double code_cost, double temperature) {
  const double mass = std::exp(found.log_sum + code_cost / (2 * temperature));
  return std::max(0.0, holds_code ? mass - 1 : mass);
}

// Posterior of the best code: against the other codes that may exist, and, with a small prior, all
// 10^12 symbols, so that a symbol whose check digit fails is not bent into one whose holds.
double posterior(const CostTable& table, const DecodeOptions& options, const Search& best,
                 double temperature) {
  constexpr double kPriorOfInvalid = 0.01;
  constexpr double kAllSymbols = 1e12;
  double rivals = 0;
  double code_count = 1e11;
  if (!options.code_book.empty()) {
    rivals = others(best, true, best.best_cost, temperature);
    code_count = static_cast<double>(options.code_book.size());
  } else {
    for (const CheckDigit scheme : schemes_of(options)) {
      rivals += others(search(table, scheme, temperature), has_check_digit(scheme, best.best),
                       best.best_cost, temperature);
    }
  }
  const Search all = search(table, std::nullopt, temperature);
  rivals +=
      kPriorOfInvalid * code_count / kAllSymbols * others(all, true, best.best_cost, temperature);
  return 1 / (1 + rivals);
}

// Alternates between the most likely digits and the adjustment of the picture to them.
std::optional<Decoding> settle(const ScanProfile& profile, const SymbolImage& start,
                               const DecodeOptions& options) {
  constexpr int kMaxRounds = 4;
  Decoding decoding;
  SymbolImage image = start;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Search best = best_code(cost_table(profile, image), options, 1.0);
    if (round > 0 && best.best == decoding.digits) break;
    decoding.digits = best.best;
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

}  // namespace

std::optional<Decoding> decode_profile(const ScanProfile& profile, const SymbolImage& start,
                                       const DecodeOptions& options) {
  constexpr std::size_t kLeastPlaces = 40;
  constexpr double kNearlyAll = 0.985;  // explained: nothing to set aside
  constexpr int kMaxCleanings = 3;
  constexpr double kLeastGuards = 0.35;  // before any adjustment
  if (profile.size() < kLeastPlaces) return std::nullopt;
  if (explained_by_guards(profile, start) < kLeastGuards) return std::nullopt;
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
  const CostTable table = cost_table(cleaned.profile, decoding->fit.image);
  const Search best = best_code(table, options, temperature);
  decoding->confidence =
      best.best == decoding->digits ? posterior(table, options, best, temperature) : 0;
  return decoding;
}

}  // namespace tagsmith
