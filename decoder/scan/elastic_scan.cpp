// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/elastic_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tagsmith/base/normal.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

constexpr int kPerModule = 5;  // samples of a resampled line
constexpr int kSegments = 15;  // start guard, 6 digits, centre guard, 6 digits, end guard
constexpr int kMargin = 14;    // modules of a resampled line on both sides of the symbol
constexpr int kSlack = 5;      // modules that a boundary may be off
constexpr int kQuiet = 5;      // modules of quiet zone that are looked at
constexpr int kRatios = 9;     // local module widths: 31 to 39 samples for seven modules
constexpr int kNominalRatio = 4;
constexpr int kSamplesPerDigit = kModulesPerDigit * kPerModule;
constexpr int kPlaces = 2 * kSlack * kPerModule + 1;
constexpr int kLineSamples = (kModuleCount + 2 * kMargin) * kPerModule;
constexpr int kTemplates = 20;  // ten digits; for the left half ten more of even parity
constexpr float kFar = 1e9F;
// Squared residual per sample of a good line: 0.14 of the contrast, much of it shared by a module's
// samples. Tuned, with the penalties below, on rendered symbols (tests/reader/frameless_test.cpp).
constexpr float kSampleWeight = 1.0F / (0.02F * kPerModule);

int modules_of_segment(int segment) {
  if (segment == 0 || segment == 14) return 3;
  return segment == 7 ? 5 : kModulesPerDigit;
}

int nominal_begin(int segment) {
  if (segment == 0) return 0;
  if (segment <= 7) return 3 + kModulesPerDigit * (segment - 1);
  return 50 + kModulesPerDigit * (segment - 8);
}

bool is_digit(int segment) { return modules_of_segment(segment) == kModulesPerDigit; }
bool is_left(int segment) { return segment < 7; }
int position_of(int segment) { return segment < 7 ? segment - 1 : segment - 2; }

// Samples that a segment takes at a local module width.
int length_of(int segment, int ratio) {
  static const auto lengths = [] {
    std::array<std::array<int, kRatios>, kModulesPerDigit + 1> table{};
    for (int modules = 0; modules <= kModulesPerDigit; ++modules) {
      for (int r = 0; r < kRatios; ++r) {
        const double relative = 1 + static_cast<double>(r - kNominalRatio) / kSamplesPerDigit;
        table[static_cast<std::size_t>(modules)][static_cast<std::size_t>(r)] =
            static_cast<int>(std::lround(modules * kPerModule * relative));
      }
    }
    return table;
  }();
  return lengths[static_cast<std::size_t>(modules_of_segment(segment))]
                [static_cast<std::size_t>(ratio)];
}

using Bars = std::vector<std::array<double, 2>>;  // begins and ends, modules

void add_bars(Bars& bars, std::span<const std::uint8_t> widths, bool bar) {
  double at = 0;
  for (const std::uint8_t width : widths) {
    if (bar) bars.push_back({at, at + width});
    at += width;
    bar = !bar;
  }
}

// The bars of a segment's pattern and of the modules beside it, whose colours are known: the
// elements there are at least one module wide. 10 to 19 are digits of even parity.
Bars bars_of(int segment, int pattern) {
  constexpr double kBeside = 1.4;
  const double end = modules_of_segment(segment);
  Bars bars;
  if (!is_digit(segment)) {
    if (segment == 7) {
      bars = {{-kBeside, 0}, {1, 2}, {3, 4}, {5, 5 + kBeside}};
    } else {
      bars = {{0, 1}, {2, 3}};
    }
    return bars;
  }
  std::array<std::uint8_t, kElementsPerDigit> widths =
      kDigitElements[static_cast<std::size_t>(pattern % 10)];
  if (pattern >= 10) std::ranges::reverse(widths);
  add_bars(bars, widths, !is_left(segment));
  if (is_left(segment)) {
    bars.push_back({-kBeside, 0});
  } else {
    bars.push_back({end, end + kBeside});
  }
  return bars;
}

double coverage(const Bars& bars, const BarShape& shape, double at) {
  const NormalTable& table = NormalTable::get();
  const auto integral = [&](double z) {
    return static_cast<double>(table(static_cast<float>(z)).integral);
  };
  double share = 0;
  for (const auto& [begin, end] : bars) {
    share += integral((at - begin + shape.growth / 2) / shape.blur) -
             integral((at - end - shape.growth / 2) / shape.blur);
  }
  return std::min(share, 1.0);
}

std::vector<float> samples_of(int segment, int pattern, int length, const BarShape& shape) {
  const Bars bars = bars_of(segment, pattern);
  const double modules = modules_of_segment(segment);
  std::vector<float> samples;
  for (int i = 0; i < length; ++i) {
    samples.push_back(static_cast<float>(coverage(bars, shape, (i + 0.5) * modules / length)));
  }
  return samples;
}

// Segments that look alike share their templates.
std::size_t kind_of(int segment) {
  if (segment == 7) return 1;
  if (!is_digit(segment)) return segment == 0 ? 0 : 4;
  return is_left(segment) ? 2 : 3;
}

constexpr std::array<int, 5> kSegmentOfKind{0, 7, 1, 8, 14};

int patterns_of(int segment) {
  if (!is_digit(segment)) return 1;
  return is_left(segment) ? kTemplates : 10;
}

// A line at kPerModule samples a module, the symbol nominally from kMargin modules on. Each sample
// is the mean of what it covers; beyond the line's ends its last samples continue.
std::vector<float> resampled(const ScanLine& line, double begin, double module, int count) {
  std::vector<double> integral(line.size() + 1, 0.0);
  for (std::size_t i = 0; i < line.size(); ++i) integral[i + 1] = integral[i] + line[i];
  const auto size = static_cast<double>(line.size());
  const auto sum_to = [&](double at) {
    const double inside = std::clamp(at, 0.0, size);
    const auto i = std::min(static_cast<std::size_t>(inside), line.size() - 1);
    const double sum = integral[i] + (inside - static_cast<double>(i)) * line[i];
    return sum + (at < 0 ? at * line.front() : std::max(0.0, at - size) * line.back());
  };
  const double step = module / kPerModule;
  std::vector<float> samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double from = begin + (i - kMargin * kPerModule) * step;
    samples.push_back(static_cast<float>((sum_to(from + step) - sum_to(from)) / step));
  }
  return samples;
}

// Costs of one segment: for each place where it may begin, local module width and pattern.
class SegmentCosts {
 public:
  // The first `patterns` of those that may stand there, or `only` one.
  SegmentCosts(std::span<const float> darkness, int segment, const BarTemplates& templates,
               int patterns, std::optional<int> only)
      : patterns_(only ? 1 : std::min(patterns, patterns_of(segment))),
        costs_(static_cast<std::size_t>(kPlaces * kRatios * patterns_), 0.0F) {
    const int first = (kMargin + nominal_begin(segment) - kSlack) * kPerModule;
    const std::span<const float> from = darkness.subspan(static_cast<std::size_t>(first));
    for (int ratio = 0; ratio < kRatios; ++ratio) {
      for (int pattern = 0; pattern < patterns_; ++pattern) {
        add_residuals(from, templates.samples(kind_of(segment), only.value_or(pattern), ratio),
                      &costs_[index(0, ratio, pattern)]);
      }
    }
    fill_best();
  }

  int patterns() const { return patterns_; }
  float cost(int place, int ratio, int pattern) const {
    return costs_[index(place, ratio, pattern)];
  }

  // The least of the patterns that UPC-A has there.
  float best(int place, int ratio) const {
    return best_[static_cast<std::size_t>(ratio * kPlaces + place)];
  }

 private:
  std::size_t index(int place, int ratio, int pattern) const {
    return static_cast<std::size_t>((ratio * patterns_ + pattern) * kPlaces + place);
  }

  // Places innermost: they are independent of each other, so the sums run side by side.
  static void add_residuals(std::span<const float> darkness, const std::vector<float>& shown,
                            float* costs) {
    for (std::size_t i = 0; i < shown.size(); ++i) {
      for (std::size_t place = 0; place < kPlaces; ++place) {
        const float difference = darkness[i + place] - shown[i];
        costs[place] += kSampleWeight * difference * difference;
      }
    }
  }

  void fill_best() {
    best_.assign(static_cast<std::size_t>(kPlaces * kRatios), kFar);
    for (int ratio = 0; ratio < kRatios; ++ratio) {
      for (int pattern = 0; pattern < std::min(patterns_, 10); ++pattern) {
        for (int place = 0; place < kPlaces; ++place) {
          float& least = best_[static_cast<std::size_t>(ratio * kPlaces + place)];
          least = std::min(least, cost(place, ratio, pattern));
        }
      }
    }
  }

  int patterns_;
  std::vector<float> costs_;
  std::vector<float> best_;
};

// State of the chain at a boundary: where it lies and how wide the modules before it were.
using Front = std::array<std::array<float, kRatios>, kPlaces>;

Front filled(float value) {
  Front front;
  for (auto& row : front) row.fill(value);
  return front;
}

using Penalties = std::array<std::array<float, kRatios>, kRatios>;  // [from][to]

Penalties penalties_for(double sigma) {
  constexpr double kLevelSigma = 0.15;
  Penalties table{};
  for (int from = 0; from < kRatios; ++from) {
    for (int to = 0; to < kRatios; ++to) {
      const double change = static_cast<double>(to - from) / kSamplesPerDigit / sigma;
      const double level = static_cast<double>(to - kNominalRatio) / kSamplesPerDigit / kLevelSigma;
      table[static_cast<std::size_t>(from)][static_cast<std::size_t>(to)] =
          static_cast<float>(change * change + level * level);
    }
  }
  return table;
}

// Local widths change slowly; guard patterns are too short to tell theirs closely.
const Penalties& change_penalties(int segment) {
  static const Penalties digits = penalties_for(0.04);
  static const Penalties guards = penalties_for(0.08);
  return is_digit(segment) && is_digit(segment - 1) ? digits : guards;
}

float change_penalty(int segment, int from, int to) {
  return change_penalties(segment)[static_cast<std::size_t>(from)][static_cast<std::size_t>(to)];
}

// Where the next boundary lies, as a place of its own window, or -1.
int next_place(int segment, int place, int ratio) {
  const int offset = place + length_of(segment, ratio) - modules_of_segment(segment) * kPerModule;
  return offset >= 0 && offset < kPlaces ? offset : -1;
}

class Chain {
 public:
  // Over all symbols, with even parity besides when `with_rivals`, or over the distortions of one.
  Chain(std::span<const float> darkness, const BarTemplates& templates, const Digits* digits,
        bool with_rivals)
      : darkness_(darkness) {
    costs_.reserve(kSegments);
    for (int s = 0; s < kSegments; ++s) {
      std::optional<int> only;
      if (digits != nullptr && is_digit(s)) {
        only = (*digits)[static_cast<std::size_t>(position_of(s))];
      }
      costs_.emplace_back(darkness, s, templates, with_rivals ? kTemplates : 10, only);
    }
    run_backward();
  }

  double cost_per_module() const {
    float least = kFar;
    const Front begin = begins();
    for (int place = 0; place < kPlaces; ++place) {
      for (int r = 0; r < kRatios; ++r)
        least = std::min(least, around(0, begin, place, r) + costs_[0].best(place, r));
    }
    return least / (kModuleCount + 2 * kQuiet);
  }

  ElasticAlignment alignment() const {
    ElasticAlignment result;
    const std::vector<std::array<int, 2>> path = best_path();
    for (std::size_t s = 0; s < path.size(); ++s) {
      result.boundaries[s] = (nominal_begin(static_cast<int>(s)) - kSlack) +
                             static_cast<double>(path[s][0]) / kPerModule;
    }
    result.boundaries[kSegments] =
        result.boundaries[kSegments - 1] +
        static_cast<double>(length_of(kSegments - 1, path.back()[1])) / kPerModule;
    result.cost_per_module = cost_per_module();
    return result;
  }

  ElasticReading reading() const {
    ElasticReading result;
    result.alignment = alignment();
    const std::vector<std::array<int, 2>> path = best_path();
    const std::vector<Front> entry = entries();
    for (int s = 0; s < kSegments; ++s) {
      const auto i = static_cast<std::size_t>(s);
      if (is_digit(s)) add_digit(s, entry[i], path[i], result);
    }
    return result;
  }

 private:
  float quiet_cost(int first) const {
    float sum = 0;
    for (int i = first; i < first + kQuiet * kPerModule; ++i) {
      const float dark = std::clamp(darkness_[static_cast<std::size_t>(i)], 0.0F, 1.0F);
      sum += dark * dark;
    }
    return sum * kSampleWeight;
  }

  // The quiet zone before the first bar.
  Front begins() const {
    Front front = filled(kFar);
    for (int place = 0; place < kPlaces; ++place) {
      const int begin = (kMargin - kSlack - kQuiet) * kPerModule + place;
      front[static_cast<std::size_t>(place)].fill(quiet_cost(begin));
    }
    return front;
  }

  // For each segment: least cost of all before it, by the place where it begins and its local
  // width, the change of width included.
  std::vector<Front> entries() const {
    std::vector<Front> entry{begins()};
    for (int s = 0; s + 1 < kSegments; ++s) {
      const Front exit = exits(s, entry.back());
      const Penalties& penalties = change_penalties(s + 1);
      Front next = filled(kFar);
      for (std::size_t place = 0; place < kPlaces; ++place) {
        for (std::size_t from = 0; from < kRatios; ++from) {
          for (std::size_t to = 0; to < kRatios; ++to) {
            next[place][to] = std::min(next[place][to], exit[place][from] + penalties[from][to]);
          }
        }
      }
      entry.push_back(next);
    }
    return entry;
  }

  // Costs at the boundary after segment s, by the place there and the segment's width.
  Front exits(int s, const Front& entry) const {
    Front exit = filled(kFar);
    for (int place = 0; place < kPlaces; ++place) {
      for (int r = 0; r < kRatios; ++r) {
        const int next = next_place(s, place, r);
        if (next < 0) continue;
        float& cell = exit[static_cast<std::size_t>(next)][static_cast<std::size_t>(r)];
        cell = std::min(cell, entry[static_cast<std::size_t>(place)][static_cast<std::size_t>(r)] +
                                  costs_[static_cast<std::size_t>(s)].best(place, r));
      }
    }
    return exit;
  }

  // remain_[s](place, ratio): least cost of all after segment s that begins at a place and has a
  // local width.
  void run_backward() {
    remain_.assign(kSegments, filled(kFar));
    for (int s = kSegments - 1; s >= 0; --s) {
      const Front after = s + 1 < kSegments ? onwards(s + 1) : ends();
      Front& remain = remain_[static_cast<std::size_t>(s)];
      for (int place = 0; place < kPlaces; ++place) {
        for (int r = 0; r < kRatios; ++r) {
          const int next = next_place(s, place, r);
          if (next < 0) continue;
          remain[static_cast<std::size_t>(place)][static_cast<std::size_t>(r)] =
              after[static_cast<std::size_t>(next)][static_cast<std::size_t>(r)];
        }
      }
    }
  }

  // Least cost from a place on, where segment s begins, by the width of the segment before.
  Front onwards(int s) const {
    const Penalties& penalties = change_penalties(s);
    const SegmentCosts& costs = costs_[static_cast<std::size_t>(s)];
    const Front& remain = remain_[static_cast<std::size_t>(s)];
    Front least = filled(kFar);
    for (std::size_t place = 0; place < kPlaces; ++place) {
      for (std::size_t to = 0; to < kRatios; ++to) {
        const float cost =
            costs.best(static_cast<int>(place), static_cast<int>(to)) + remain[place][to];
        for (std::size_t from = 0; from < kRatios; ++from) {
          least[place][from] = std::min(least[place][from], cost + penalties[from][to]);
        }
      }
    }
    return least;
  }

  // The quiet zone after the last bar.
  Front ends() const {
    Front front = filled(kFar);
    for (int place = 0; place < kPlaces; ++place) {
      const int end = (kMargin - kSlack + kModuleCount) * kPerModule + place;
      front[static_cast<std::size_t>(place)].fill(quiet_cost(end));
    }
    return front;
  }

  // Cost of the whole line with segment s at a place and width, its own pattern apart.
  float around(int s, const Front& entry, int place, int r) const {
    const auto p = static_cast<std::size_t>(place);
    const auto ratio = static_cast<std::size_t>(r);
    return entry[p][ratio] + remain_[static_cast<std::size_t>(s)][p][ratio];
  }

  // Place and width of every segment on the best path.
  std::vector<std::array<int, 2>> best_path() const {
    std::vector<std::array<int, 2>> path;
    float total = kFar;
    std::array<int, 2> first{0, 0};
    const Front begin = begins();
    for (int place = 0; place < kPlaces; ++place) {
      for (int r = 0; r < kRatios; ++r) {
        const float cost = around(0, begin, place, r) + costs_[0].best(place, r);
        if (cost >= total) continue;
        total = cost;
        first = {place, r};
      }
    }
    path.push_back(first);
    for (int s = 1; s < kSegments; ++s) path.push_back(step(s, path.back()));
    return path;
  }

  std::array<int, 2> step(int s, const std::array<int, 2>& before) const {
    const int place = std::max(0, next_place(s - 1, before[0], before[1]));
    std::array<int, 2> best{place, kNominalRatio};
    float least = kFar;
    for (int to = 0; to < kRatios; ++to) {
      const float cost = change_penalty(s, before[1], to) +
                         costs_[static_cast<std::size_t>(s)].best(place, to) +
                         remain_[static_cast<std::size_t>(s)][static_cast<std::size_t>(place)]
                                [static_cast<std::size_t>(to)];
      if (cost >= least) continue;
      least = cost;
      best[1] = to;
    }
    return best;
  }

  void add_digit(int s, const Front& entry, const std::array<int, 2>& on_path,
                 ElasticReading& result) const {
    const auto total =
        static_cast<float>(result.alignment.cost_per_module * (kModuleCount + 2 * kQuiet));
    const auto position = static_cast<std::size_t>(position_of(s));
    const SegmentCosts& costs = costs_[static_cast<std::size_t>(s)];
    std::array<float, kTemplates> least;
    least.fill(kFar);
    for (int place = 0; place < kPlaces; ++place) {
      for (int r = 0; r < kRatios; ++r) {
        const float base = around(s, entry, place, r);
        if (base >= kFar) continue;
        for (int p = 0; p < costs.patterns(); ++p) {
          auto& cell = least[static_cast<std::size_t>(p)];
          cell = std::min(cell, base + costs.cost(place, r, p));
        }
      }
    }
    int best = 0;
    for (int p = 1; p < 10; ++p) {
      if (costs.cost(on_path[0], on_path[1], p) < costs.cost(on_path[0], on_path[1], best))
        best = p;
    }
    result.digits[position] = static_cast<std::uint8_t>(best);
    for (std::size_t p = 0; p < 10; ++p) {
      result.extra_cost[position][p] = std::max(0.0F, least[p] - total);
    }
    if (is_left(s)) {
      result.even_parity_cost[position] =
          *std::min_element(least.begin() + 10, least.end()) - total;
    }
  }

  std::span<const float> darkness_;
  std::vector<SegmentCosts> costs_;
  std::vector<Front> remain_;
};

// Greatest (or, with negated samples, least) value within `window` samples to both sides.
std::vector<float> running_maximum(const std::vector<float>& samples, std::size_t window) {
  // Blocks of 2 window + 1: running maxima from both ends of each (van Herk 1992, Gil and Werman
  // 1993).
  const std::size_t block = 2 * window + 1;
  const std::size_t padded = samples.size() + 2 * window;
  const auto at = [&](std::size_t i) {
    return samples[std::clamp<std::size_t>(i, window, window + samples.size() - 1) - window];
  };
  std::vector<float> ahead(padded), behind(padded);
  for (std::size_t i = 0; i < padded; ++i) {
    ahead[i] = i % block == 0 ? at(i) : std::max(ahead[i - 1], at(i));
  }
  for (std::size_t i = padded; i-- > 0;) {
    behind[i] = i + 1 == padded || (i + 1) % block == 0 ? at(i) : std::max(behind[i + 1], at(i));
  }
  std::vector<float> result(samples.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = std::max(behind[i], ahead[i + 2 * window]);
  }
  return result;
}

std::vector<float> running_mean(const std::vector<float>& samples, std::size_t window) {
  std::vector<double> integral(samples.size() + 1, 0.0);
  for (std::size_t i = 0; i < samples.size(); ++i) integral[i + 1] = integral[i] + samples[i];
  std::vector<float> result(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t from = i > window ? i - window : 0;
    const std::size_t to = std::min(samples.size(), i + window + 1);
    result[i] =
        static_cast<float>((integral[to] - integral[from]) / static_cast<double>(to - from));
  }
  return result;
}

// Mean darkness of the module that begins at each sample; of its middle three samples, because its
// edges are blurred.
std::vector<float> module_darkness(const std::vector<float>& darkness) {
  std::vector<float> modules(darkness.size(), 0.0F);
  const auto clamped = [&](std::size_t i) { return std::clamp(darkness[i], 0.0F, 1.0F); };
  for (std::size_t i = 0; i + kPerModule <= darkness.size(); ++i) {
    modules[i] = (clamped(i + 1) + clamped(i + 2) + clamped(i + 3)) / 3;
  }
  return modules;
}

// How badly a pattern of modules (1 bar, 0 space) that begins at each sample suits: 1 less its
// correlation with the darkness, which blur lowers little. Even grey correlates with nothing.
std::vector<float> pattern_costs(const std::vector<float>& modules, std::span<const int> pattern) {
  constexpr float kLeastDeviation = 0.15F;  // of darkness within the pattern
  const auto count = static_cast<float>(pattern.size());
  const std::size_t length = pattern.size() * kPerModule;
  float mean = 0;
  for (const int bar : pattern) mean += static_cast<float>(bar) / count;
  const float deviation = std::sqrt(mean * (1 - mean));
  std::vector<float> costs(modules.size(), kFar);
  for (std::size_t i = 0; i + length <= modules.size(); ++i) {
    float sum = 0;
    float squares = 0;
    float product = 0;
    for (std::size_t m = 0; m < pattern.size(); ++m) {
      const float dark = modules[i + m * kPerModule];
      sum += dark;
      squares += dark * dark;
      product += dark * (static_cast<float>(pattern[m]) - mean);
    }
    const float variance = squares / count - sum * sum / (count * count);
    const float seen = std::max(kLeastDeviation, std::sqrt(std::max(0.0F, variance)));
    costs[i] = 1 - product / count / (seen * deviation);
  }
  return costs;
}

// Of three guard patterns together, of 0 to 6. Right places of crumpled and glaring products stay
// below.
constexpr float kWorstPlace = 1.5F;

constexpr std::array<int, 8> kStartPattern{0, 0, 0, 0, 1, 0, 1, 0};
constexpr std::array<int, 7> kCentrePattern{1, 0, 1, 0, 1, 0, 1};
constexpr std::array<int, 8> kEndPattern{0, 1, 0, 1, 0, 0, 0, 0};

// A symbol may reach beyond the line by what its boundaries may be off.
bool has_room(const ScanLine& line, const SymbolPlace& place) {
  const double reach = kSlack * std::abs(place.module);
  const double end = place.begin + kModuleCount * place.module;
  const auto size = static_cast<double>(line.size());
  return std::min(place.begin, end) >= -reach && std::max(place.begin, end) <= size + reach;
}

// Where a begin suits, for one module width; in samples of the line resampled to that width.
std::vector<SymbolPlace> places_at_width(const ScanLine& line, double module) {
  const auto length = static_cast<int>(static_cast<double>(line.size()) / module * kPerModule);
  const int count = length + 2 * kMargin * kPerModule;
  const std::vector<float> samples = resampled(line, 0, module, count);
  const std::vector<float> modules = module_darkness(local_darkness(samples, 9 * kPerModule));
  const std::vector<float> start = pattern_costs(modules, kStartPattern);
  const std::vector<float> centre = pattern_costs(modules, kCentrePattern);
  const std::vector<float> end = pattern_costs(modules, kEndPattern);
  const auto least_near = [&](const std::vector<float>& costs, int middle, int slack) {
    std::array<float, 2> best{kFar, 0};
    for (int i = middle - slack; i <= middle + slack; ++i) {
      if (i < 0 || i >= static_cast<int>(costs.size())) continue;
      if (costs[static_cast<std::size_t>(i)] < best[0])
        best = {costs[static_cast<std::size_t>(i)], static_cast<float>(i)};
    }
    return best;
  };
  std::vector<SymbolPlace> places;
  for (int i = 0; i < count - (kModuleCount - 4) * kPerModule; ++i) {
    const float at_start = start[static_cast<std::size_t>(i)];
    if (at_start > kWorstPlace / 2) continue;
    const int first_bar = i + 4 * kPerModule;
    const auto at_centre = least_near(centre, first_bar + 44 * kPerModule, 3 * kPerModule);
    if (at_start + at_centre[0] > kWorstPlace) continue;
    const auto at_end = least_near(end, first_bar + 91 * kPerModule, 3 * kPerModule);
    const float cost = at_start + at_centre[0] + at_end[0];
    if (cost > kWorstPlace) continue;
    const double begin = first_bar - kMargin * kPerModule;
    const double width = (static_cast<double>(at_end[1]) - first_bar) / 91 * module / kPerModule;
    const SymbolPlace place{begin * module / kPerModule, width, cost};
    if (has_room(line, place)) places.push_back(place);
  }
  return places;
}

}  // namespace

BarTemplates::BarTemplates(const BarShape& shape) {
  for (std::size_t kind = 0; kind < samples_.size(); ++kind) {
    const int segment = kSegmentOfKind[kind];
    for (int pattern = 0; pattern < patterns_of(segment); ++pattern) {
      for (int ratio = 0; ratio < kRatios; ++ratio) {
        samples_[kind].push_back(samples_of(segment, pattern, length_of(segment, ratio), shape));
      }
    }
  }
}

const std::vector<float>& BarTemplates::samples(std::size_t kind, int pattern, int ratio) const {
  return samples_[kind][static_cast<std::size_t>(pattern * kRatios + ratio)];
}

std::vector<float> local_darkness(const ScanLine& line, std::size_t window) {
  constexpr float kLeastShare = 0.2F;  // of the line's whole contrast: less is no bars
  std::vector<float> negated(line);
  for (float& sample : negated) sample = -sample;
  const std::vector<float> white = running_mean(running_maximum(line, window), window / 2);
  const std::vector<float> black = running_mean(running_maximum(negated, window), window / 2);
  const auto [low, high] = std::ranges::minmax_element(line);
  const float least = std::max(kLeastShare * (*high - *low), 1e-6F);
  std::vector<float> darkness(line.size());
  for (std::size_t i = 0; i < line.size(); ++i) {
    darkness[i] = (white[i] - line[i]) / std::max(white[i] + black[i], least);
  }
  return darkness;
}

std::vector<SymbolPlace> find_symbol_places(const ScanLine& line, double least, double greatest,
                                            std::size_t most) {
  constexpr double kStep = 1.045;
  std::vector<SymbolPlace> all;
  if (line.size() < 40) return all;
  for (double module = least; module <= greatest; module *= kStep) {
    std::ranges::move(places_at_width(line, module), std::back_inserter(all));
  }
  std::ranges::sort(all, {}, &SymbolPlace::cost);
  std::vector<SymbolPlace> best;
  for (const SymbolPlace& place : all) {
    const auto same = [&](const SymbolPlace& other) {
      const double end = place.begin + kModuleCount * place.module;
      const double other_end = other.begin + kModuleCount * other.module;
      return std::abs(place.begin - other.begin) < 1.5 * place.module &&
             std::abs(end - other_end) < 1.5 * place.module;
    };
    if (std::ranges::any_of(best, same)) continue;
    best.push_back(place);
    if (best.size() == most) break;
  }
  return best;
}

namespace {

// A line resampled about a place, as darkness, the symbol running along it.
struct PlacedLine {
  std::vector<float> darkness;
  double begin = 0;  // of the place, samples of the line in its own or the turned direction
  double module = 0;
  double turned_size = 0;  // samples of the line when it was turned, else 0

  void to_line(ElasticAlignment& alignment) const {
    for (double& boundary : alignment.boundaries) {
      boundary = begin + boundary * module;
      if (turned_size > 0) boundary = turned_size - boundary;
    }
  }
};

std::optional<PlacedLine> placed_line(const ScanLine& line, const SymbolPlace& place) {
  const auto size = static_cast<double>(line.size());
  if (line.size() < 2 || !(std::abs(place.module) > 0.1) || !has_room(line, place)) {
    return std::nullopt;
  }
  PlacedLine placed{{}, place.begin, place.module, 0};
  if (place.module < 0) {
    const ScanLine turned(line.rbegin(), line.rend());
    placed = {{}, size - place.begin, -place.module, size};
    placed.darkness = resampled(turned, placed.begin, placed.module, kLineSamples);
  } else {
    placed.darkness = resampled(line, placed.begin, placed.module, kLineSamples);
  }
  placed.darkness = local_darkness(placed.darkness, 9 * kPerModule);
  return placed;
}

}  // namespace

double elastic_cost(const ScanLine& line, const SymbolPlace& place, const BarTemplates& templates) {
  const auto placed = placed_line(line, place);
  if (!placed) return kFar;
  return Chain(placed->darkness, templates, nullptr, false).cost_per_module();
}

std::optional<ElasticReading> read_elastic(const ScanLine& line, const SymbolPlace& place,
                                           const BarTemplates& templates) {
  const auto placed = placed_line(line, place);
  if (!placed) return std::nullopt;
  ElasticReading reading = Chain(placed->darkness, templates, nullptr, true).reading();
  placed->to_line(reading.alignment);
  return reading;
}

std::optional<ElasticAlignment> align_elastic(const ScanLine& line, const SymbolPlace& place,
                                              const BarTemplates& templates, const Digits& digits) {
  const auto placed = placed_line(line, place);
  if (!placed) return std::nullopt;
  ElasticAlignment alignment = Chain(placed->darkness, templates, &digits, false).alignment();
  placed->to_line(alignment);
  return alignment;
}

}  // namespace tagsmith
