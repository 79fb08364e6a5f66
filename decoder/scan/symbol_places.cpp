// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/symbol_places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "decoder/scan/running.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/base/wide.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

constexpr float kNoGuard = 1e9F;

std::vector<float> darkness_of(const std::vector<float>& placed) {
  return local_darkness(placed, kWideElementsWithin * kPlacedPerModule);
}

// The light of a line up to any place; beyond its ends its last samples continue.
class LineIntegral {
 public:
  explicit LineIntegral(const ScanLine& line) : line_(line), sums_(line.size() + 1, 0.0) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      sums_[i + 1] = sums_[i] + static_cast<double>(line[i]);
    }
  }

  double to(double at) const {
    const auto size = static_cast<double>(line_.size());
    if (at < 0) return at * static_cast<double>(line_.front());
    if (at >= size) return sums_.back() + (at - size) * static_cast<double>(line_.back());
    const auto i = static_cast<std::size_t>(at);
    return sums_[i] + (at - static_cast<double>(i)) * static_cast<double>(line_[i]);
  }

 private:
  const ScanLine& line_;
  std::vector<double> sums_;
};

// A line at kPlacedPerModule samples a module, the symbol nominally from kPlacedMargin modules on.
// Each sample is the mean of what it covers.
std::vector<float> resampled(const LineIntegral& line, double begin, double module, int count) {
  const double step = module / kPlacedPerModule;
  std::vector<float> samples(static_cast<std::size_t>(count));
  double before = line.to(begin - kPlacedMargin * kPlacedPerModule * step);
  for (int i = 0; i < count; ++i) {
    const double sum = line.to(begin + (i + 1 - kPlacedMargin * kPlacedPerModule) * step);
    samples[static_cast<std::size_t>(i)] = static_cast<float>((sum - before) / step);
    before = sum;
  }
  return samples;
}

// Mean darkness of the module that begins at each sample; of its middle three samples, because its
// edges are blurred. Clamps the samples; `of_modules` has as many places.
TAGSMITH_WIDE void average_modules(float* samples, std::size_t count, float* of_modules) {
  for (std::size_t i = 0; i < count; ++i) {
    const float above = samples[i] < 0.0F ? 0.0F : samples[i];
    samples[i] = above < 1.0F ? above : 1.0F;
  }
  for (std::size_t i = 0; i + kPlacedPerModule <= count; ++i) {
    of_modules[i] = (samples[i + 1] + samples[i + 2] + samples[i + 3]) / 3;
  }
}

std::vector<float> module_darkness(std::vector<float> darkness) {
  std::vector<float> modules(darkness.size(), 0.0F);
  average_modules(darkness.data(), darkness.size(), modules.data());
  return modules;
}

// How badly the three guard patterns that begin at each sample suit: 1 minus the correlation of
// their modules with the darkness, which blur lowers little. Even grey correlates with nothing.
// With quiet zones: 00001010 at the start, 1010101 in the centre, 01010000 at the end (1 = bar).
struct GuardCosts {
  std::vector<float> start, centre, end;
};

// 1 - correlation, from the sum of the bars' modules and the sums over all.
struct PatternFit {
  float bars, count;

  // Their covariance with the pattern, times the count.
  float product(float of_bars, float sum) const { return of_bars - bars / count * sum; }
  // The divisor of such a product.
  float deviations(float variance) const {
    const float share = bars / count;
    return count * std::sqrt(variance * share * (1 - share));
  }
};

constexpr std::size_t kOuter = 8, kCentre = 7;  // modules of the patterns
constexpr PatternFit kOuterFit{2, kOuter}, kCentreFit{4, kCentre};

// The variances of the darkness within the patterns that begin at each of `count` samples.
TAGSMITH_WIDE void vary(const float* modules, std::size_t count, float* outer, float* centre) {
  constexpr float kLeast = kPlace.least_deviation * kPlace.least_deviation;
  for (std::size_t i = 0; i < count; ++i) {
    float sum = 0, squares = 0;
    for (std::size_t k = 0; k < kCentre; ++k) {
      const float module = modules[i + k * kPlacedPerModule];
      sum += module;
      squares += module * module;
    }
    const float inside = squares / kCentre - sum * sum / (kCentre * kCentre);
    centre[i] = inside > kLeast ? inside : kLeast;
    const float last = modules[i + kCentre * kPlacedPerModule];
    sum += last;
    squares += last * last;
    const float whole = squares / kOuter - sum * sum / (kOuter * kOuter);
    outer[i] = whole > kLeast ? whole : kLeast;
  }
}

// The costs of those that begin at each of `count` samples, in place of the variances.
TAGSMITH_WIDE void fit_guards(const float* modules, std::size_t count, float* start, float* centre,
                              float* outer_to_end) {
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, kOuter> m;
    for (std::size_t k = 0; k < kOuter; ++k) m[k] = modules[i + k * kPlacedPerModule];
    float sum = 0;
    for (std::size_t k = 0; k < kCentre; ++k) sum += m[k];
    centre[i] =
        1 - kCentreFit.product(m[0] + m[2] + m[4] + m[6], sum) / kCentreFit.deviations(centre[i]);
    sum += m[kCentre];
    const float outer = 1 / kOuterFit.deviations(outer_to_end[i]);
    start[i] = 1 - kOuterFit.product(m[4] + m[6], sum) * outer;
    outer_to_end[i] = 1 - kOuterFit.product(m[1] + m[3], sum) * outer;
  }
}

GuardCosts guard_costs(const std::vector<float>& modules) {
  const std::size_t size = modules.size();
  GuardCosts costs{std::vector<float>(size, kNoGuard), std::vector<float>(size, kNoGuard),
                   std::vector<float>(size, kNoGuard)};
  if (size < kOuter * kPlacedPerModule) return costs;
  const std::size_t count = size - kOuter * kPlacedPerModule + 1;
  vary(modules.data(), count, costs.end.data(), costs.centre.data());
  fit_guards(modules.data(), count, costs.start.data(), costs.centre.data(), costs.end.data());
  return costs;
}

// A symbol may reach beyond the line by the tolerance of its boundaries.
bool has_room(const ScanLine& line, const SymbolPlace& place) {
  const double reach = kPlacedSlack * std::abs(place.module);
  const double end = place.begin + kModuleCount * place.module;
  const auto size = static_cast<double>(line.size());
  return std::min(place.begin, end) >= -reach && std::max(place.begin, end) <= size + reach;
}

// The cost of a begin, for one module width; in samples of the line resampled to that width.
std::vector<SymbolPlace> places_at_width(const ScanLine& line, const LineIntegral& integral,
                                         double module) {
  const auto length =
      static_cast<int>(static_cast<double>(line.size()) / module * kPlacedPerModule);
  const int count = length + 2 * kPlacedMargin * kPlacedPerModule;
  const std::vector<float> samples = resampled(integral, 0, module, count);
  const std::vector<float> modules = module_darkness(darkness_of(samples));
  const GuardCosts guards = guard_costs(modules);
  // The costs of the best places within kPlace.slack.
  constexpr std::size_t kSlackSamples = kPlace.slack * kPlacedPerModule;
  const std::vector<float> centres = running_minimum(guards.centre, kSlackSamples);
  const std::vector<float> ends = running_minimum(guards.end, kSlackSamples);
  std::vector<SymbolPlace> places;
  for (int i = 0; i < count - (kModuleCount - kPlace.slack) * kPlacedPerModule; ++i) {
    const float at_start = guards.start[static_cast<std::size_t>(i)];
    if (at_start > kPlace.worst / 2) continue;
    const int first_bar = i + 4 * kPlacedPerModule;
    const auto last_guard =
        static_cast<std::size_t>(std::min(count - 1, first_bar + 91 * kPlacedPerModule));
    const float cost = at_start +
                       centres[static_cast<std::size_t>(first_bar + 44 * kPlacedPerModule)] +
                       ends[last_guard];
    if (cost > kPlace.worst) continue;
    const auto first = guards.end.begin() + (first_bar + 91 * kPlacedPerModule) - kSlackSamples;
    const auto at_end = std::find(first, guards.end.end(), ends[last_guard]);
    const double begin = first_bar - kPlacedMargin * kPlacedPerModule;
    const auto bars = static_cast<double>(at_end - guards.end.begin()) - first_bar;
    const double width = bars / 91 * module / kPlacedPerModule;
    const SymbolPlace place{begin * module / kPlacedPerModule, width, cost};
    if (has_room(line, place)) places.push_back(place);
  }
  return places;
}

}  // namespace

std::vector<SymbolPlace> find_symbol_places(const ScanLine& line, double least, double greatest,
                                            std::size_t most) {
  std::vector<SymbolPlace> all;
  if (line.size() < 40) return all;
  const LineIntegral integral(line);
  for (double module = least; module <= greatest; module *= kPlace.step) {
    std::ranges::move(places_at_width(line, integral, module), std::back_inserter(all));
  }
  std::ranges::sort(all, {}, &SymbolPlace::cost);
  std::vector<SymbolPlace> best;
  for (const SymbolPlace& place : all) {
    const auto same = [&](const SymbolPlace& other) {
      const double end = place.begin + kModuleCount * place.module;
      const double other_end = other.begin + kModuleCount * other.module;
      return std::abs(place.begin - other.begin) < kPlace.slack * place.module &&
             std::abs(end - other_end) < kPlace.slack * place.module;
    };
    if (std::ranges::any_of(best, same)) continue;
    best.push_back(place);
    if (best.size() == most) break;
  }
  return best;
}

std::optional<PlacedLine> placed_line(const ScanLine& line, const SymbolPlace& place) {
  const auto size = static_cast<double>(line.size());
  if (line.size() < 2 || !(std::abs(place.module) > 0.1) || !has_room(line, place)) {
    return std::nullopt;
  }
  constexpr int kSamples = (kModuleCount + 2 * kPlacedMargin) * kPlacedPerModule;
  PlacedLine placed{{}, place.begin, place.module, 0};
  if (place.module < 0) {
    const ScanLine turned(line.rbegin(), line.rend());
    placed = {{}, size - place.begin, -place.module, size};
    placed.darkness = resampled(LineIntegral(turned), placed.begin, placed.module, kSamples);
  } else {
    placed.darkness = resampled(LineIntegral(line), placed.begin, placed.module, kSamples);
  }
  placed.darkness = darkness_of(placed.darkness);
  return placed;
}

}  // namespace tagsmith::detail
