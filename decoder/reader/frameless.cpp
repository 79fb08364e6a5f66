// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/frameless.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/reader/bar_lines.hpp"
#include "decoder/reader/bar_regions.hpp"
#include "decoder/scan/decode.hpp"
#include "decoder/scan/elastic_scan.hpp"
#include "decoder/scan/running.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

constexpr std::size_t kMostRegions = 10;
constexpr std::size_t kBinsPerModule = 4;
constexpr double kBeyond = 4;  // modules of quiet zone in a straightened profile

// A look of bars that is tried, the plain one first.
struct Shape {
  BarShape bars;
  BarTemplates templates;
};

const std::vector<Shape>& shapes() {
  static const auto all = [] {
    std::vector<Shape> list;
    for (const double blur : {0.5, 0.3, 0.75, 1.05}) {
      for (const double growth : {0.0, -0.3, 0.3}) {
        const BarShape bars{blur, growth};
        list.push_back({bars, BarTemplates(bars)});
      }
    }
    return list;
  }();
  return all;
}

// One line of a region that a symbol was read from.
// Why: docs/decisions/0009-symbols-without-a-frame.md.
struct ReadLine {
  double offset = 0;  // along the bars, pixels
  ScanLine light;
  ElasticReading reading;
};

SymbolPlace place_of(const ElasticAlignment& alignment) {
  const double begin = alignment.boundaries.front();
  return {begin, (alignment.boundaries.back() - begin) / kModuleCount, 0};
}

// A region with its lines and how its bars look.
struct RegionScan {
  LineFrame frame;
  double spacing = 0;  // of the lines along the bars, pixels
  const Shape* shape = nullptr;
  std::vector<ReadLine> lines;
};

// A place on one of the lines that are looked at first.
struct FirstPlace {
  std::size_t line = 0;
  SymbolPlace place;
};

// How little like a symbol of the region's size the first line may be.
struct FirstLineLimits {
  double least_module = 0.5;  // of what the region's length says
  double greatest_module = 1.8;
  double worst_place = kWorstPlace;
  double worst_cost = 4;  // per module; a blurred symbol's
};

// What is wanted of a line: where its symbol lies, or its digits too, which takes twice as long.
enum class Wanted { alignment, digits };

std::optional<ElasticReading> read_line(const PlacedLine& line, const BarTemplates& templates,
                                        Wanted wanted, double worst = kAnyCost) {
  if (wanted == Wanted::digits) return read_elastic(line, templates, worst);
  const auto alignment = align_elastic(line, templates, worst);
  if (!alignment) return std::nullopt;
  ElasticReading reading;
  reading.alignment = *alignment;
  return reading;
}

// The line to start from, of three thick ones, and its reading: the best of the places whose guard
// patterns suit best, in either direction.
std::optional<ReadLine> first_line(SampledLight& image, const LineFrame& frame,
                                   const BarRegion& region, Wanted wanted,
                                   const FirstLineLimits& limits = {}) {
  constexpr std::size_t kMostPlaces = 10;
  constexpr double kGood = 1;  // no need to look further
  const double nominal_module = region.length / kModuleCount / frame.step;
  std::vector<ReadLine> lines;
  std::vector<FirstPlace> places;
  for (const double share : {0.0, -0.25, 0.25}) {
    const double offset = share * region.height;
    lines.push_back({offset, light_along(image, frame, offset, region.height / 8), {}});
    for (const SymbolPlace& place : find_symbol_places(
             lines.back().light, limits.least_module * nominal_module,
             limits.greatest_module * nominal_module, kMostPlaces, limits.worst_place)) {
      places.push_back({lines.size() - 1, place});
    }
  }
  std::ranges::stable_sort(places, {}, [](const FirstPlace& p) { return p.place.cost; });
  if (places.size() > kMostPlaces) places.resize(kMostPlaces);
  double best = limits.worst_cost;
  std::optional<FirstPlace> found;
  for (const auto& [line, place] : places) {
    const double end = place.begin + kModuleCount * place.module;
    for (const SymbolPlace& way : {place, SymbolPlace{end, -place.module, place.cost}}) {
      const auto placed = placed_line(lines[line].light, way);
      if (!placed) continue;
      const double cost = elastic_cost(*placed, shapes().front().templates, best);
      if (cost >= best) continue;
      best = cost;
      found = FirstPlace{line, way};
    }
    if (best < kGood) break;
  }
  if (!found) return std::nullopt;
  ReadLine first = std::move(lines[found->line]);
  const auto placed = placed_line(first.light, found->place);
  if (!placed) return std::nullopt;
  const auto reading = read_line(*placed, shapes().front().templates, wanted);
  if (!reading) return std::nullopt;
  first.reading = *reading;
  return first;
}

// The look of the bars that suits the line best, and its reading so.
const Shape& best_shape(ReadLine& line, Wanted wanted) {
  const SymbolPlace place = place_of(line.reading.alignment);
  const Shape* best = &shapes().front();
  const auto placed = placed_line(line.light, place);
  if (!placed) return *best;
  double least = line.reading.alignment.cost_per_module;
  for (const Shape& shape : shapes()) {
    const double cost = elastic_cost(*placed, shape.templates, least);
    if (cost >= least) continue;
    least = cost;
    best = &shape;
  }
  if (const auto reading = read_line(*placed, best->templates, wanted)) line.reading = *reading;
  return *best;
}

// Leaves out the lines that read much worse than most: they lie beyond the bars or in dirt.
void drop_strays(std::vector<ReadLine>& lines) {
  constexpr double kTimesMedian = 2.5;
  constexpr double kGood = 1.5;  // cost per module
  std::vector<double> costs;
  for (const ReadLine& line : lines) costs.push_back(line.reading.alignment.cost_per_module);
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
  std::ranges::nth_element(costs, middle);
  const double most = std::max(kGood, kTimesMedian * *middle);
  std::erase_if(
      lines, [&](const ReadLine& line) { return line.reading.alignment.cost_per_module > most; });
}

bool is_inside(const SampledLight& image, PixelPoint at) {
  return at.x >= 0 && at.y >= 0 && at.x <= image.width() - 1 && at.y <= image.height() - 1;
}

// Reads the region's lines from the first one outwards, each where its neighbour was.
RegionScan scan_region(SampledLight& image, const LineFrame& frame, const BarRegion& region,
                       ReadLine first, const Shape& shape, int lines, Wanted wanted) {
  constexpr double kWorst = 4;  // a line worse than this is dirt or lies beyond the bars
  constexpr int kMostMisses = 3;
  RegionScan scan{frame, std::max(1.0, region.height / lines), &shape, {}};
  for (const double direction : {-1.0, 1.0}) {
    SymbolPlace place = place_of(first.reading.alignment);
    int misses = 0;
    for (double offset = first.offset + direction * scan.spacing;
         std::abs(offset) < 0.6 * region.height && misses < kMostMisses;
         offset += direction * scan.spacing) {
      if (!is_inside(image, frame.pixel(place.begin + kModuleCount / 2.0 * place.module, offset))) {
        break;
      }
      ScanLine light = light_along(image, frame, offset, scan.spacing);
      const auto placed = placed_line(light, place);
      const auto reading =
          placed ? read_line(*placed, shape.templates, wanted, kWorst) : std::nullopt;
      if (!reading || reading->alignment.cost_per_module > kWorst) {
        ++misses;
        continue;
      }
      place = place_of(reading->alignment);
      scan.lines.push_back({offset, std::move(light), *reading});
    }
  }
  scan.lines.push_back(std::move(first));
  drop_strays(scan.lines);
  std::ranges::sort(scan.lines, {}, &ReadLine::offset);
  return scan;
}

// Modules of an alignment's boundaries.
constexpr std::array<double, 16> kModules{0,  3,  10, 17, 24, 31, 38, 45,
                                          50, 57, 64, 71, 78, 85, 92, 95};

// Module coordinate of a place of the line, by the line's own distortion; linear beyond the ends.
double module_at(const ElasticAlignment& alignment, double place) {
  const auto& at = alignment.boundaries;
  const double sign = at.back() > at.front() ? 1 : -1;
  std::size_t i = 0;
  while (i + 2 < at.size() && sign * (place - at[i + 1]) > 0) ++i;
  if (place * sign < at.front() * sign || place * sign > at.back() * sign) {
    const double mean = (at.back() - at.front()) / kModuleCount;
    const bool before = place * sign < at.front() * sign;
    return before ? (place - at.front()) / mean : kModuleCount + (place - at.back()) / mean;
  }
  const double share = (place - at[i]) / (at[i + 1] - at[i]);
  return kModules[i] + share * (kModules[i + 1] - kModules[i]);
}

constexpr std::size_t kBins =
    static_cast<std::size_t>((kModuleCount + 2 * kBeyond) * kBinsPerModule);

// A line's darkness by module, straightened; not a number where the line does not reach.
std::array<float, kBins> straightened(const ReadLine& line) {
  const double module = std::abs(place_of(line.reading.alignment).module);
  const std::vector<float> darkness =
      local_darkness(line.light, static_cast<std::size_t>(std::lround(9 * module)));
  std::array<float, kBins> sums{};
  std::array<int, kBins> counts{};
  constexpr int kFiner = 4;
  for (std::size_t i = 0; i < darkness.size() * kFiner; ++i) {
    const double place = (static_cast<double>(i) + 0.5) / kFiner;
    const double bin = (module_at(line.reading.alignment, place) + kBeyond) * kBinsPerModule;
    if (!(bin >= 0 && bin < static_cast<double>(kBins))) continue;
    sums[static_cast<std::size_t>(bin)] += darkness[i / kFiner];
    ++counts[static_cast<std::size_t>(bin)];
  }
  std::array<float, kBins> result{};
  for (std::size_t b = 0; b < kBins; ++b) {
    result[b] = counts[b] > 0 ? sums[b] / static_cast<float>(counts[b])
                              : std::numeric_limits<float>::quiet_NaN();
  }
  return result;
}

// The lines' darkness together: at each place the mean of those that agree with their median.
ScanProfile merged_profile(const std::vector<ReadLine>& lines) {
  constexpr float kAgreeing = 0.2F;       // of the contrast
  constexpr double kLineVariance = 0.01;  // of one line: noise, and places off by a tenth module
  constexpr double kModelError = 0.03;
  std::vector<std::array<float, kBins>> rows;
  rows.reserve(lines.size());
  for (const ReadLine& line : lines) rows.push_back(straightened(line));
  ScanProfile profile;
  for (std::size_t b = 0; b < kBins; ++b) {
    std::vector<float> values;
    for (const auto& row : rows) {
      if (!std::isnan(row[b])) values.push_back(row[b]);
    }
    if (values.empty()) continue;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    const float median = *middle;
    double sum = 0;
    double count = 0;
    for (const float value : values) {
      if (std::abs(value - median) > kAgreeing) continue;
      sum += value;
      ++count;
    }
    const double agreement = count / static_cast<double>(values.size());
    const double doubt = std::min(1.0, 2 * (1 - agreement));
    profile.push_back(
        {(static_cast<double>(b) + 0.5) / kBinsPerModule - kBeyond, sum / count,
         kLineVariance / count + kModelError * kModelError + doubt * doubt * doubt * doubt,
         agreement});
  }
  return profile;
}

// What the lines say together about each digit, in units of log likelihood.
struct Evidence {
  std::array<std::array<double, 10>, kDigitCount> cost{};
  std::array<double, 6> even_parity{};
};

Evidence evidence_of(const std::vector<ReadLine>& lines) {
  constexpr double kMostOfALine = 30;  // what one line can say against a digit: it may be dirty
  // Lines share blur, print and dirt: together they count as a few independent ones.
  constexpr double kIndependent = 3;
  const double share = std::min(1.0, kIndependent / static_cast<double>(lines.size())) / 2;
  Evidence evidence;
  for (const ReadLine& line : lines) {
    const double weight = share / std::max(1.0, line.reading.alignment.cost_per_module);
    for (std::size_t i = 0; i < kDigitCount; ++i) {
      for (std::size_t d = 0; d < 10; ++d) {
        evidence.cost[i][d] += weight * std::min(kMostOfALine, line.reading.extra_cost[i][d]);
      }
    }
    for (std::size_t i = 0; i < 6; ++i) {
      evidence.even_parity[i] +=
          weight * std::clamp(line.reading.even_parity_cost[i], -kMostOfALine, kMostOfALine);
    }
  }
  return evidence;
}

// The most likely code and its probability among those that may exist.
struct Consensus {
  Digits digits{};
  double probability = 0;
};

double cost_of(const Evidence& evidence, const Digits& digits) {
  double cost = 0;
  for (std::size_t i = 0; i < kDigitCount; ++i) cost += evidence.cost[i][digits[i]];
  return cost;
}

// What a digit adds to the sum that is 0 modulo 10 for valid symbols.
std::size_t check_term(CheckDigit scheme, std::size_t position, std::size_t digit) {
  if (scheme == CheckDigit::gs1) return (position % 2 == 0 ? 3 : 1) * digit % 10;
  return position + 1 == kDigitCount ? (10 - digit) % 10 : digit;
}

// Codes whose check digit holds: the best of them, and exp(-cost) summed over them all.
struct ValidCodes {
  Digits best{};
  double cost = 0;
  double mass = 0;
};

ValidCodes valid_codes(const Evidence& evidence, CheckDigit scheme) {
  struct Cell {
    double cost = std::numeric_limits<double>::infinity();
    double mass = 0;
    Digits digits{};
  };
  std::array<Cell, 10> sums;
  sums[0] = {0, 1, {}};
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    std::array<Cell, 10> next;
    for (std::size_t sum = 0; sum < 10; ++sum) {
      for (std::size_t digit = 0; digit < 10; ++digit) {
        Cell& cell = next[(sum + check_term(scheme, i, digit)) % 10];
        const double cost = sums[sum].cost + evidence.cost[i][digit];
        cell.mass += sums[sum].mass * std::exp(-evidence.cost[i][digit]);
        if (cost >= cell.cost) continue;
        cell.cost = cost;
        cell.digits = sums[sum].digits;
        cell.digits[i] = static_cast<std::uint8_t>(digit);
      }
    }
    sums = next;
  }
  return {sums[0].digits, sums[0].cost, sums[0].mass};
}

double mass_of_all_codes(const Evidence& evidence) {
  double product = 1;
  for (const auto& costs : evidence.cost) {
    double sum = 0;
    for (const double cost : costs) sum += std::exp(-cost);
    product *= sum;
  }
  return product;
}

// As for framed symbols (decoder/scan/decode.cpp, posterior): against the other codes that may
// exist and, with a small prior, all 10^12.
Consensus consensus_of(const Evidence& evidence, const DecodeOptions& options) {
  constexpr double kPriorOfInvalid = 0.01;
  constexpr double kAllSymbols = 1e12;
  double code_count = 1e11;
  ValidCodes codes;
  if (options.code_book.empty()) {
    codes = valid_codes(evidence, options.check.value_or(CheckDigit::gs1));
  } else {
    code_count = static_cast<double>(options.code_book.size());
    codes.cost = std::numeric_limits<double>::infinity();
    for (const Digits& digits : options.code_book) {
      const double cost = cost_of(evidence, digits);
      codes.mass += std::exp(-cost);
      if (cost >= codes.cost) continue;
      codes.cost = cost;
      codes.best = digits;
    }
  }
  const double own = std::exp(-codes.cost);
  const double rivals = (codes.mass - own) / own + kPriorOfInvalid * code_count / kAllSymbols *
                                                       (mass_of_all_codes(evidence) - own) / own;
  return {codes.best, 1 / (1 + std::max(0.0, rivals))};
}

// True when three digits of the left half suit even parity: EAN-13 with a leading digit other
// than 0 (GS1 General Specifications 5.2.1.2.1) has that in just three.
bool may_be_ean13(const Evidence& evidence) {
  constexpr double kCertain = 6;
  std::array<double, 6> costs = evidence.even_parity;
  std::ranges::sort(costs);
  return costs[0] + costs[1] + costs[2] < kCertain;
}

std::optional<std::string> objection_to(const Decoding& decoding, const Evidence& evidence,
                                        const Consensus& consensus, const ReadOptions& options) {
  constexpr double kLeastExplained = 0.85;
  constexpr double kLeastDigit = 0.6;
  constexpr double kLeastGuards = 0.7;
  constexpr double kMostGrowth = 0.7;
  constexpr double kLeastTogether = 0.9;
  if (decoding.guards < kLeastGuards) return "guard pattern";
  if (decoding.fit.explained < kLeastExplained || decoding.worst_digit < kLeastDigit) {
    return "element widths";
  }
  if (std::abs(decoding.fit.image.growth) > kMostGrowth) return "bars grown or shrunk";
  if (decoding.digits != consensus.digits) return "lines disagree";
  if (consensus.probability < options.min_confidence.value_or(kSureWithoutFrame) ||
      decoding.confidence < kLeastTogether) {
    return kDoubtfulReason;
  }
  if (may_be_ean13(evidence)) return "even parity: EAN-13";
  return std::nullopt;
}

// Every line aligned anew to what all lines say together.
std::vector<ReadLine> realigned(const RegionScan& scan, const Digits& digits) {
  std::vector<ReadLine> lines;
  for (const ReadLine& line : scan.lines) {
    const auto alignment =
        align_elastic(line.light, place_of(line.reading.alignment), scan.shape->templates, digits);
    if (!alignment) continue;
    lines.push_back(line);
    lines.back().reading.alignment = *alignment;
  }
  return lines;
}

// Outline of the lines that were read, clockwise from the upper left as the digits run.
std::array<PixelPoint, 4> outline_of(const RegionScan& scan) {
  const ReadLine& first = scan.lines.front();
  const ReadLine& last = scan.lines.back();
  const double half = scan.spacing / 2;
  const auto at = [&](const ReadLine& line, bool end, double beyond) {
    const auto& boundaries = line.reading.alignment.boundaries;
    return scan.frame.pixel(end ? boundaries.back() : boundaries.front(), line.offset + beyond);
  };
  std::array<PixelPoint, 4> bars{at(first, false, -half), at(first, true, -half),
                                 at(last, true, half), at(last, false, half)};
  if (cross(bars[1] - bars[0], bars[3] - bars[0]) < 0) {
    std::swap(bars[0], bars[3]);
    std::swap(bars[1], bars[2]);
  }
  return bars;
}

std::vector<std::array<PixelPoint, 2>> line_ends(const RegionScan& scan) {
  std::vector<std::array<PixelPoint, 2>> ends;
  for (const ReadLine& line : scan.lines) {
    const auto& boundaries = line.reading.alignment.boundaries;
    ends.push_back({scan.frame.pixel(boundaries.front(), line.offset),
                    scan.frame.pixel(boundaries.back(), line.offset)});
  }
  return ends;
}

// What a region's bars say; nothing where they are not much like a symbol.
std::optional<FramelessTrace> trace_region(SampledLight& image, const BarRegion& region,
                                           const ReadOptions& options) {
  // Beyond these a refusal is not worth telling: any texture is explained by enough blur.
  constexpr double kSymbolLike = 0.85;
  constexpr double kMostBlur = 1.5;  // modules
  const LineFrame frame = line_frame_for(image, region);
  constexpr int kLines = 12;
  auto first = first_line(image, frame, region, Wanted::digits);
  if (!first) return std::nullopt;
  const Shape& shape = best_shape(*first, Wanted::digits);
  const RegionScan scan =
      scan_region(image, frame, region, std::move(*first), shape, kLines, Wanted::digits);
  DecodeOptions decode_options{options.check, options.code_book};
  if (!options.check && options.code_book.empty()) decode_options.check = CheckDigit::gs1;
  const Evidence evidence = evidence_of(scan.lines);
  const Consensus consensus = consensus_of(evidence, decode_options);
  FramelessTrace trace;
  trace.profile = merged_profile(realigned(scan, consensus.digits));
  SymbolImage start;
  start.blur = scan.shape->bars.blur;
  const auto decoding = decode_profile(trace.profile, start, decode_options);
  if (!decoding || decoding->fit.explained < kSymbolLike || decoding->fit.image.blur > kMostBlur) {
    return std::nullopt;
  }
  trace.decoding = *decoding;
  trace.digits = consensus.digits;
  trace.confidence = consensus.probability;
  trace.objection = objection_to(*decoding, evidence, consensus, options);
  trace.bars = outline_of(scan);
  trace.lines = line_ends(scan);
  trace.module_px =
      (distance(trace.bars[0], trace.bars[1]) + distance(trace.bars[3], trace.bars[2])) / 2 /
      kModuleCount;
  return trace;
}

FramelessReading reading_of(const FramelessTrace& trace) {
  return {trace.digits,
          has_check_digit(CheckDigit::sum10, trace.digits),
          has_check_digit(CheckDigit::gs1, trace.digits),
          trace.bars,
          trace.module_px,
          trace.confidence};
}

}  // namespace

std::vector<FramelessTrace> trace_frameless(PictureBars& bars, const ReadOptions& options) {
  std::vector<FramelessTrace> traces;
  for (const BarRegion& region : bars.regions.whole(kMostRegions)) {
    const auto covers = [&](const FramelessTrace& other) {
      return !other.objection && contains(other.bars, region.centre);
    };
    if (std::ranges::any_of(traces, covers)) continue;
    if (auto trace = trace_region(bars.light, region, options)) traces.push_back(std::move(*trace));
  }
  return traces;
}

FramelessResult read_frameless(PictureBars& bars, const ReadOptions& options) {
  FramelessResult result;
  for (const FramelessTrace& trace : trace_frameless(bars, options)) {
    // Bars seen at two reductions of the image are the same.
    const auto same = [&](const auto& other) {
      return contains(other.bars, 0.5 * (trace.bars[0] + trace.bars[2]));
    };
    if (!trace.objection) {
      if (std::ranges::none_of(result.read, same)) result.read.push_back(reading_of(trace));
    } else if (std::ranges::none_of(result.rejected, same)) {
      result.rejected.push_back({*trace.objection, trace.bars});
    }
  }
  const auto read = [&](const FramelessRejection& rejection) {
    const PixelPoint centre = 0.5 * (rejection.bars[0] + rejection.bars[2]);
    return std::ranges::any_of(result.read, [&](const FramelessReading& reading) {
      return contains(reading.bars, centre);
    });
  };
  std::erase_if(result.rejected, read);
  return result;
}

namespace {

// Fits the modules of the lines' boundaries; those that most others contradict count little.
LocatedBars fit_bars(const RegionScan& scan, PixelPoint centre) {
  constexpr double kTolerance = 0.5;  // modules
  constexpr int kRounds = 6;
  constexpr double kUnit = 100;  // pixels: conditions the equations
  LocatedBars bars;
  bars.centre = centre;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
    for (const ReadLine& line : scan.lines) {
      for (std::size_t i = 0; i < kModules.size(); ++i) {
        const PixelPoint pixel =
            scan.frame.pixel(line.reading.alignment.boundaries[i], line.offset);
        const PixelPoint p = 1 / kUnit * (pixel - centre);
        const double module = kModules[i];
        const double below = 1 + kUnit * dot(bars.c, p);
        const double off = (bars.a + kUnit * dot(bars.b, p)) / below - module;
        const double ratio = round == 0 ? 0 : off / kTolerance;
        const double weight = 1 / (below * below * (1 + ratio * ratio));
        Eigen::Matrix<double, 5, 1> row;
        row << 1, p.x, p.y, -module * p.x, -module * p.y;
        normal += weight * row * row.transpose();
        right += weight * module * row;
      }
    }
    const Eigen::Matrix<double, 5, 1> x = normal.ldlt().solve(right);
    bars.a = x[0];
    bars.b = {x[1] / kUnit, x[2] / kUnit};
    bars.c = {x[3] / kUnit, x[4] / kUnit};
  }
  return bars;
}

// Whether a line begins and ends with the bars, and crosses them where they were followed.
bool is_line_of(const LocatedBars& bars, PixelPoint begin, PixelPoint end) {
  constexpr double kTolerance = 1;  // modules
  double first = bars.module_of(begin), last = bars.module_of(end);
  if (first > last) std::swap(first, last);
  const double middle = kModuleCount / 2.0;
  const PixelPoint across = bars.normal_at(middle);
  const PixelPoint along = 1 / length(across) * PixelPoint{-across.y, across.x};
  return std::abs(first) < kTolerance && std::abs(last - kModuleCount) < kTolerance &&
         std::abs(dot(0.5 * (begin + end) - bars.centre, along)) < bars.height / 2;
}

}  // namespace

std::optional<LocatedBars> locate_bars(SampledLight& image, const BarRegion& region,
                                       std::span<const LocatedBars> located) {
  constexpr std::size_t kLeastLines = 3;
  constexpr double kAsHigh = 0.8;  // more of the bars would not be followed
  const LineFrame frame = line_frame_for(image, region);
  constexpr int kLines = 10;
  // Bars of covered tags that were read: modules of 0.67 to 1.05 of what their length says, costs
  // of 0.7 and 1.9 at most (`./dev bench troubled`).
  constexpr FirstLineLimits kLimits{
      .least_module = 0.5, .greatest_module = 1.3, .worst_place = 0.9, .worst_cost = 2.5};
  auto first = first_line(image, frame, region, Wanted::alignment, kLimits);
  if (!first) return std::nullopt;
  const auto& boundaries = first->reading.alignment.boundaries;
  const PixelPoint begin = frame.pixel(boundaries.front(), first->offset);
  const PixelPoint end = frame.pixel(boundaries.back(), first->offset);
  const auto same = [&](const LocatedBars& bars) {
    return bars.height > kAsHigh * region.height && is_line_of(bars, begin, end);
  };
  if (std::ranges::any_of(located, same)) return std::nullopt;
  const double middle = (boundaries.front() + boundaries.back()) / 2;
  const Shape& shape = best_shape(*first, Wanted::alignment);
  const RegionScan scan =
      scan_region(image, frame, region, std::move(*first), shape, kLines, Wanted::alignment);
  if (scan.lines.size() < kLeastLines) return std::nullopt;
  const double offset = (scan.lines.front().offset + scan.lines.back().offset) / 2;
  LocatedBars bars = fit_bars(scan, scan.frame.pixel(middle, offset));
  bars.height = scan.lines.back().offset - scan.lines.front().offset + scan.spacing;
  return bars;
}

namespace {

// Whether the middle of a symbol's bars lies in a frame.
template <class Symbol, class Framed>
bool stands_in(const Symbol& symbol, const Framed& framed) {
  return contains(framed.corners, 0.5 * (symbol.bars[0] + symbol.bars[2]));
}

template <class Symbol>
bool stands_in_any(const Symbol& symbol, const std::vector<Reading>& tags) {
  return std::ranges::any_of(tags, [&](const Reading& tag) { return stands_in(symbol, tag); });
}

// The framed symbol at the place of a frameless one that was refused for what covers it or makes it
// doubtful, if there is one.
const Rejection* doubted_at(const FramelessReading& reading,
                            const std::vector<Rejection>& rejected) {
  const auto at = std::ranges::find_if(rejected, [&](const Rejection& framed) {
    return (framed.reason == kDoubtfulReason || framed.reason == kCoveredReason) &&
           stands_in(reading, framed);
  });
  return at == rejected.end() ? nullptr : &*at;
}

}  // namespace

ReadResult with_frameless(PictureBars& bars, const ReadOptions& options, ReadResult result) {
  const bool wanted = options.frameless == Frameless::always ||
                      (options.frameless == Frameless::fallback && result.tags.empty());
  if (!wanted) return result;
  FramelessResult& frameless = result.frameless;
  frameless = read_frameless(bars, options);
  const auto is_read = [&](const auto& symbol) { return stands_in_any(symbol, result.tags); };
  std::erase_if(frameless.read, is_read);
  std::erase_if(frameless.rejected, is_read);
  std::erase_if(frameless.read, [&](const FramelessReading& reading) {
    const Rejection* doubted = doubted_at(reading, result.rejected);
    if (doubted != nullptr) frameless.rejected.push_back({doubted->reason, reading.bars});
    return doubted != nullptr;
  });
  return result;
}

}  // namespace tagsmith
