// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/elastic_scan.hpp"

#include <algorithm>
#include <cmath>

#include "decoder/scan/place_rows.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/base/statistics.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kSegments = 15;         // start guard, 6 digits, centre guard, 6 digits, end guard
constexpr int kSlack = kPlacedSlack;  // modules that a boundary may be off
constexpr int kRatios = 9;            // local module widths: 31 to 39 samples for seven modules
constexpr int kNominalRatio = 4;
constexpr int kSamplesPerDigit = kModulesPerDigit * kPlacedPerModule;
constexpr int kPlaces = 2 * kSlack * kPlacedPerModule + 1;
constexpr int kTemplates = 20;  // ten digits; for the left half ten more of even parity
static_assert(kPlaces == kPlaceCount && kRatios == kWidthCount);
constexpr float kSampleWeight = 1.0F / (kElastic.variance * kPlacedPerModule);

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
            static_cast<int>(std::lround(modules * kPlacedPerModule * relative));
      }
    }
    return table;
  }();
  return lengths[static_cast<std::size_t>(modules_of_segment(segment))]
                [static_cast<std::size_t>(ratio)];
}

// Where bars of a segment begin and end, in modules. At -1 and one module behind the segment's end
// are the nearest edges that may be beside it, whose elements have colours that are known.
using Bars = std::vector<std::array<int, 2>>;

void add_bars(Bars& bars, std::span<const std::uint8_t> widths, bool bar) {
  int at = 0;
  for (const std::uint8_t width : widths) {
    if (bar) bars.push_back({at, at + width});
    at += width;
    bar = !bar;
  }
}

// The bars of a segment's pattern and of its neighbours. 10 to 19 are digits of even parity.
Bars bars_of(int segment, int pattern) {
  const int end = modules_of_segment(segment);
  if (segment == 7) return {{-1, 0}, {1, 2}, {3, 4}, {end, end + 1}};
  if (!is_digit(segment)) return {{0, 1}, {2, 3}};
  Bars bars;
  std::array<std::uint8_t, kElementsPerDigit> widths =
      kDigitElements[static_cast<std::size_t>(pattern % 10)];
  if (pattern >= 10) std::ranges::reverse(widths);
  add_bars(bars, widths, !is_left(segment));
  if (is_left(segment)) {
    bars.push_back({-1, 0});
  } else {
    bars.push_back({end, end + 1});
  }
  return bars;
}

// For each sample of a segment and each edge that its bars may have: how much of a bar that begins
// there, and of one that ends there, lies before the sample, blurred.
class EdgeIntegrals {
 public:
  EdgeIntegrals(int modules, int length, const BarShape& shape) {
    constexpr double kBeside = 1.4;  // modules to the nearest edge beside the segment
    const NormalTable& table = NormalTable::get();
    const auto integral = [&](double z) {
      return static_cast<double>(table(static_cast<float>(z / shape.blur)).integral);
    };
    for (int i = 0; i < length; ++i) {
      const double at = (i + 0.5) * modules / length;
      Sample& sample = samples_.emplace_back();
      for (int edge = -1; edge <= modules + 1; ++edge) {
        const double place = edge < 0 ? -kBeside : edge > modules ? modules + kBeside : edge;
        sample.begins[number_of(edge)] = integral(at - place + shape.growth / 2);
        sample.ends[number_of(edge)] = integral(at - place - shape.growth / 2);
      }
    }
  }

  // The bars' share of the light at each sample.
  std::vector<float> shares_of(const Bars& bars) const {
    std::vector<float> shares;
    shares.reserve(samples_.size());
    for (const Sample& sample : samples_) {
      double share = 0;
      for (const auto& [begin, end] : bars) {
        share += sample.begins[number_of(begin)] - sample.ends[number_of(end)];
      }
      shares.push_back(static_cast<float>(std::min(share, 1.0)));
    }
    return shares;
  }

 private:
  struct Sample {
    std::array<double, kModulesPerDigit + 3> begins{}, ends{};
  };

  static std::size_t number_of(int edge) { return static_cast<std::size_t>(edge + 1); }

  std::vector<Sample> samples_;
};

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

// A line's darkness and its squares up to each sample.
class LineDarkness {
 public:
  explicit LineDarkness(std::span<const float> samples) : samples_(samples), squares_{0} {
    squares_.reserve(samples.size() + 1);
    for (const float sample : samples) {
      squares_.push_back(squares_.back() + static_cast<double>(sample * sample));
    }
  }

  std::span<const float> samples() const { return samples_; }
  // Over `count` samples from each place on, the first of which is `first`.
  PlaceRow squares(int first, std::size_t count) const {
    PlaceRow row;
    const double* from = squares_.data() + first;
    for (std::size_t i = 0; i < kPlaceRow; ++i) {
      row[i] = static_cast<float>(from[i + count] - from[i]);
    }
    return row;
  }

 private:
  std::span<const float> samples_;
  std::vector<double> squares_;
};

// Costs of one segment: for each place where it may begin, local module width and pattern.
class SegmentCosts {
 public:
  // For the ten patterns that UPC-A has there, or for `only` one; each is kept when asked for.
  SegmentCosts(const LineDarkness& line, int segment, const BarTemplates& templates,
               std::optional<int> only, bool keep)
      : segment_(segment), best_(filled_rows(kFarCost)) {
    const int patterns = only ? 1 : std::min(10, patterns_of(segment));
    for (std::size_t ratio = 0; ratio < kWidthCount; ++ratio) {
      const auto length = static_cast<std::size_t>(length_of(segment, static_cast<int>(ratio)));
      squares_[ratio] = line.squares(first_sample(), length);
    }
    for (int pattern = 0; pattern < patterns; ++pattern) {
      for (std::size_t ratio = 0; ratio < kWidthCount; ++ratio) {
        const PlaceRow costs = row_of(line, templates, only.value_or(pattern), ratio);
        take_less(costs, best_[ratio]);
        if (keep) rows_.push_back(costs);
      }
    }
    for (PlaceRow& row : best_) std::fill(row.begin() + kPlaces, row.end(), kFarCost);
  }

  // Keeps the additional patterns of EAN-13 there, too.
  void add_rivals(const LineDarkness& line, const BarTemplates& templates) {
    for (int pattern = 10; pattern < patterns_of(segment_); ++pattern) {
      for (std::size_t ratio = 0; ratio < kWidthCount; ++ratio) {
        rows_.push_back(row_of(line, templates, pattern, ratio));
      }
    }
  }

  std::size_t patterns() const { return rows_.size() / kWidthCount; }
  const PlaceRow& row(std::size_t pattern, std::size_t ratio) const {
    return rows_[pattern * kWidthCount + ratio];
  }
  // The least cost of the patterns that UPC-A has there.
  const PlaceRows& best() const { return best_; }

 private:
  int first_sample() const {
    return (kPlacedMargin + nominal_begin(segment_) - kSlack) * kPlacedPerModule;
  }

  // Squared differences of a pattern from the line at every place: squares of both, less twice
  // their product.
  PlaceRow row_of(const LineDarkness& line, const BarTemplates& templates, int pattern,
                  std::size_t ratio) const {
    const BarTemplates::Template& shown =
        templates.shown(kind_of(segment_), pattern, static_cast<int>(ratio));
    PlaceRow row = products(line.samples().data() + first_sample(), shown.samples.data(),
                            shown.samples.size());
    for (std::size_t i = 0; i < kPlaceRow; ++i) {
      row[i] = kSampleWeight * (squares_[ratio][i] + shown.squares - 2 * row[i]);
    }
    return row;
  }

  int segment_;
  PlaceRows squares_;  // of the darkness that a segment of each width covers
  std::vector<PlaceRow> rows_;
  PlaceRows best_;
};

WidthPenalties width_penalties() {
  WidthPenalties table{};
  for (int from = 0; from < kRatios; ++from) {
    for (int to = 0; to < kRatios; ++to) {
      const double change =
          static_cast<double>(to - from) / kSamplesPerDigit / kElastic.change_sigma;
      const double level =
          static_cast<double>(to - kNominalRatio) / kSamplesPerDigit / kElastic.level_sigma;
      table[static_cast<std::size_t>(from)][static_cast<std::size_t>(to)] =
          static_cast<float>(change * change + level * level);
    }
  }
  return table;
}

// Local widths change slowly.
const WidthPenalties& change_penalties() {
  static const WidthPenalties penalties = width_penalties();
  return penalties;
}

WidthPenalties transposed(const WidthPenalties& table) {
  WidthPenalties result{};
  for (std::size_t i = 0; i < kWidthCount; ++i) {
    for (std::size_t j = 0; j < kWidthCount; ++j) result[i][j] = table[j][i];
  }
  return result;
}

// The same by the width after, then the one before.
const WidthPenalties& penalties_backwards() {
  static const WidthPenalties penalties = transposed(width_penalties());
  return penalties;
}

// By how many places a segment of a local width moves the next boundary in its own window.
int shift_of(int segment, std::size_t ratio) {
  return length_of(segment, static_cast<int>(ratio)) -
         modules_of_segment(segment) * kPlacedPerModule;
}

// A row moved by some places: values from outside cost kFarCost.
PlaceRow moved(const PlaceRow& row, int shift) {
  PlaceRow result;
  result.fill(kFarCost);
  const int first = std::max(0, shift), end = std::min(kPlaces, kPlaces + shift);
  std::copy(row.begin() + (first - shift), row.begin() + (end - shift), result.begin() + first);
  return result;
}

// The chain of a symbol's segments over a line, by dynamic programming from its end.
class Chain {
 public:
  enum class Keep { best, patterns };

  // Over all symbols, or over the distortions of one. The chain is abandoned, and costs kFarCost,
  // as soon as it is certain to cost more than `worst` per module.
  Chain(std::span<const float> darkness, const BarTemplates& templates, const Digits* digits,
        Keep keep, double worst)
      : line_(darkness), remain_(kSegments, filled_rows(kFarCost)), begins_(quiet_costs(0)) {
    const auto most = static_cast<float>(std::min(1e8, worst * kWeighedModules));
    costs_.reserve(kSegments);
    PlaceRows after = quiet_costs(kModuleCount);
    for (int s = kSegments - 1; s >= 0; --s) {
      std::optional<int> only;
      if (digits != nullptr && is_digit(s)) {
        only = (*digits)[static_cast<std::size_t>(position_of(s))];
      }
      costs_.emplace_back(line_, s, templates, only, keep == Keep::patterns && is_digit(s));
      PlaceRows& remain = remain_[static_cast<std::size_t>(s)];
      for (std::size_t r = 0; r < kWidthCount; ++r) remain[r] = moved(after[r], -shift_of(s, r));
      if (s == 0) break;
      after = onwards(s);
      if (least_of(after) > most) return;
    }
    least_ = find_least();
  }

  bool is_given_up() const { return !(least_ < kFarCost); }
  double cost_per_module() const {
    return is_given_up() ? static_cast<double>(kFarCost)
                         : static_cast<double>(least_ / kWeighedModules);
  }

  ElasticAlignment alignment() const { return alignment_of(best_path()); }

  ElasticReading reading(const BarTemplates& templates) {
    ElasticReading result;
    const std::vector<std::array<std::size_t, 2>> path = best_path();
    result.alignment = alignment_of(path);
    const std::vector<PlaceRows> entry = entries();
    for (int s = 0; s < kSegments; ++s) {
      if (!is_digit(s)) continue;
      const auto i = static_cast<std::size_t>(s);
      costs_of(s).add_rivals(line_, templates);
      add_digit(s, entry[i], path[i], result);
    }
    return result;
  }

 private:
  static constexpr int kWeighedModules = kModuleCount + 2 * kNearModules;

  // The segments' costs are computed from the last one on.
  const SegmentCosts& costs_of(int s) const {
    return costs_[static_cast<std::size_t>(kSegments - 1 - s)];
  }
  SegmentCosts& costs_of(int s) { return costs_[static_cast<std::size_t>(kSegments - 1 - s)]; }

  // Cost of a quiet zone before the first bar (module 0) or after the last, by the boundary's
  // place.
  PlaceRows quiet_costs(int module) const {
    PlaceRow row;
    row.fill(kFarCost);
    const int first =
        (kPlacedMargin + module - kSlack - (module == 0 ? kNearModules : 0)) * kPlacedPerModule;
    for (int place = 0; place < kPlaces; ++place) {
      float sum = 0;
      for (int i = first + place; i < first + place + kNearModules * kPlacedPerModule; ++i) {
        const float dark = std::clamp(line_.samples()[static_cast<std::size_t>(i)], 0.0F, 1.0F);
        sum += dark * dark;
      }
      row[static_cast<std::size_t>(place)] = sum * kSampleWeight;
    }
    PlaceRows rows;
    rows.fill(row);
    return rows;
  }

  // Least cost from a place on, where segment s begins, by the width of the segment before.
  PlaceRows onwards(int s) const {
    PlaceRows with_segment = costs_of(s).best();
    const PlaceRows& remain = remain_[static_cast<std::size_t>(s)];
    for (std::size_t r = 0; r < kWidthCount; ++r) {
      for (std::size_t place = 0; place < kPlaceRow; ++place) {
        with_segment[r][place] += remain[r][place];
      }
    }
    return least_onwards(with_segment, change_penalties());
  }

  // For each segment: least cost of all before it, by the place where it begins and its local
  // width, including the change of width.
  std::vector<PlaceRows> entries() const {
    std::vector<PlaceRows> entry{begins_};
    for (int s = 0; s + 1 < kSegments; ++s) {
      PlaceRows exit;
      for (std::size_t r = 0; r < kWidthCount; ++r) {
        PlaceRow row = entry.back()[r];
        for (std::size_t i = 0; i < kPlaceRow; ++i) row[i] += costs_of(s).best()[r][i];
        exit[r] = moved(row, shift_of(s, r));
      }
      entry.push_back(least_onwards(exit, penalties_backwards()));
    }
    return entry;
  }

  // Cost of the whole line with segment s at a place and width, without its own pattern.
  PlaceRow around(int s, const PlaceRows& entry, std::size_t ratio) const {
    PlaceRow row = entry[ratio];
    const PlaceRow& remain = remain_[static_cast<std::size_t>(s)][ratio];
    for (std::size_t i = 0; i < kPlaceRow; ++i) row[i] += remain[i];
    return row;
  }

  float find_least() const {
    float least = kFarCost;
    for (std::size_t r = 0; r < kWidthCount; ++r) {
      least = std::min(least, least_sum(around(0, begins_, r), costs_of(0).best()[r]));
    }
    return least;
  }

  // Place and width of every segment on the best path.
  std::vector<std::array<std::size_t, 2>> best_path() const {
    std::vector<std::array<std::size_t, 2>> path;
    float total = kFarCost;
    std::array<std::size_t, 2> first{0, 0};
    for (std::size_t place = 0; place < kPlaceCount; ++place) {
      for (std::size_t r = 0; r < kWidthCount; ++r) {
        const float cost = begins_[r][place] + remain_[0][r][place] + costs_of(0).best()[r][place];
        if (cost >= total) continue;
        total = cost;
        first = {place, r};
      }
    }
    path.push_back(first);
    for (int s = 1; s < kSegments; ++s) path.push_back(step(s, path.back()));
    return path;
  }

  std::array<std::size_t, 2> step(int s, const std::array<std::size_t, 2>& before) const {
    const int next = static_cast<int>(before[0]) + shift_of(s - 1, before[1]);
    const auto place = static_cast<std::size_t>(next >= 0 && next < kPlaces ? next : 0);
    std::array<std::size_t, 2> best{place, kNominalRatio};
    float least = kFarCost;
    for (std::size_t to = 0; to < kWidthCount; ++to) {
      const float cost = change_penalties()[before[1]][to] + costs_of(s).best()[to][place] +
                         remain_[static_cast<std::size_t>(s)][to][place];
      if (cost >= least) continue;
      least = cost;
      best[1] = to;
    }
    return best;
  }

  ElasticAlignment alignment_of(const std::vector<std::array<std::size_t, 2>>& path) const {
    ElasticAlignment result;
    for (std::size_t s = 0; s < path.size(); ++s) {
      result.boundaries[s] = (nominal_begin(static_cast<int>(s)) - kSlack) +
                             static_cast<double>(path[s][0]) / kPlacedPerModule;
    }
    const int last = length_of(kSegments - 1, static_cast<int>(path.back()[1]));
    result.boundaries[kSegments] =
        result.boundaries[kSegments - 1] + static_cast<double>(last) / kPlacedPerModule;
    result.cost_per_module = cost_per_module();
    return result;
  }

  void add_digit(int s, const PlaceRows& entry, const std::array<std::size_t, 2>& on_path,
                 ElasticReading& result) const {
    const auto total = static_cast<float>(result.alignment.cost_per_module * kWeighedModules);
    const auto position = static_cast<std::size_t>(position_of(s));
    const SegmentCosts& costs = costs_of(s);
    std::array<float, kTemplates> least;
    least.fill(kFarCost);
    for (std::size_t r = 0; r < kWidthCount; ++r) {
      const PlaceRow base = around(s, entry, r);
      for (std::size_t p = 0; p < costs.patterns(); ++p) {
        least[p] = std::min(least[p], least_sum(base, costs.row(p, r)));
      }
    }
    const auto on_place = [&](std::size_t p) { return costs.row(p, on_path[1])[on_path[0]]; };
    std::size_t best = 0;
    for (std::size_t p = 1; p < 10; ++p) {
      if (on_place(p) < on_place(best)) best = p;
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

  LineDarkness line_;
  std::vector<SegmentCosts> costs_;  // the last segment first
  std::vector<PlaceRows> remain_;    // by segment: least cost of all after it, by its own begin
  PlaceRows begins_;
  float least_ = kFarCost;
};

}  // namespace

BarTemplates::BarTemplates(const BarShape& shape) {
  for (std::size_t kind = 0; kind < templates_.size(); ++kind) {
    const int segment = kSegmentOfKind[kind];
    std::vector<EdgeIntegrals> by_ratio;
    for (int ratio = 0; ratio < kRatios; ++ratio) {
      by_ratio.emplace_back(modules_of_segment(segment), length_of(segment, ratio), shape);
    }
    for (int pattern = 0; pattern < patterns_of(segment); ++pattern) {
      const Bars bars = bars_of(segment, pattern);
      for (const EdgeIntegrals& integrals : by_ratio) {
        Template shown{integrals.shares_of(bars), 0};
        for (const float sample : shown.samples) shown.squares += sample * sample;
        templates_[kind].push_back(std::move(shown));
      }
    }
  }
}

const BarTemplates::Template& BarTemplates::shown(std::size_t kind, int pattern, int ratio) const {
  return templates_[kind][static_cast<std::size_t>(pattern * kRatios + ratio)];
}

namespace {

// Where the symbol's boundaries lie on the line itself.
void to_line(const PlacedLine& placed, ElasticAlignment& alignment) {
  for (double& boundary : alignment.boundaries) {
    boundary = placed.begin + boundary * placed.module;
    if (placed.turned_size > 0) boundary = placed.turned_size - boundary;
  }
}

}  // namespace

double elastic_cost(const PlacedLine& line, const BarTemplates& templates, double worst) {
  return Chain(line.darkness, templates, nullptr, Chain::Keep::best, worst).cost_per_module();
}

std::optional<ElasticReading> read_elastic(const PlacedLine& line, const BarTemplates& templates,
                                           double worst) {
  Chain chain(line.darkness, templates, nullptr, Chain::Keep::patterns, worst);
  if (chain.is_given_up()) return std::nullopt;
  ElasticReading reading = chain.reading(templates);
  to_line(line, reading.alignment);
  return reading;
}

std::optional<ElasticAlignment> align_elastic(const PlacedLine& line, const BarTemplates& templates,
                                              double worst) {
  const Chain chain(line.darkness, templates, nullptr, Chain::Keep::best, worst);
  if (chain.is_given_up()) return std::nullopt;
  ElasticAlignment alignment = chain.alignment();
  to_line(line, alignment);
  return alignment;
}

std::optional<ElasticAlignment> align_elastic(const ScanLine& line, const SymbolPlace& place,
                                              const BarTemplates& templates, const Digits& digits) {
  const auto placed = placed_line(line, place);
  if (!placed) return std::nullopt;
  const Chain chain(placed->darkness, templates, &digits, Chain::Keep::best, kAnyCost);
  if (chain.is_given_up()) return std::nullopt;
  ElasticAlignment alignment = chain.alignment();
  to_line(*placed, alignment);
  return alignment;
}

}  // namespace tagsmith::detail
