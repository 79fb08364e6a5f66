// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/frameless.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/reader/bar_lines.hpp"
#include "decoder/reader/judge.hpp"
#include "decoder/reader/region_scan.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/scan/decode.hpp"
#include "decoder/scan/elastic_scan.hpp"
#include "decoder/scan/explanation.hpp"
#include "decoder/scan/running.hpp"
#include "decoder/scan/symbol_search.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

constexpr std::size_t kBinsPerModule = 4;

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
  return kBoundaryModules[i] + share * (kBoundaryModules[i + 1] - kBoundaryModules[i]);
}

constexpr std::size_t kBins =
    static_cast<std::size_t>((kModuleCount + 2 * kProfile.beyond) * kBinsPerModule);

// A line's darkness by module, straightened; not a number beyond the line's ends.
std::array<float, kBins> straightened(const ReadLine& line) {
  const double module = std::abs(place_of(line.reading.alignment).module);
  const std::vector<float> darkness = local_darkness(
      line.light, static_cast<std::size_t>(std::lround(kWideElementsWithin * module)));
  std::array<float, kBins> sums{};
  std::array<int, kBins> counts{};
  constexpr int kFiner = 4;
  for (std::size_t i = 0; i < darkness.size() * kFiner; ++i) {
    const double place = (static_cast<double>(i) + 0.5) / kFiner;
    const double bin =
        (module_at(line.reading.alignment, place) + kProfile.beyond) * kBinsPerModule;
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

// The common darkness of the lines: at each place the mean of those that agree with their median.
ScanProfile merged_profile(const std::vector<ReadLine>& lines) {
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
      if (std::abs(value - median) > kProfile.odd) continue;
      sum += value;
      ++count;
    }
    const double agreement = count / static_cast<double>(values.size());
    const double doubt = std::min(1.0, 2 * (1 - agreement));
    profile.push_back(
        {(static_cast<double>(b) + 0.5) / kBinsPerModule - kProfile.beyond, sum / count,
         static_cast<double>(kElastic.variance) / count +
             kProfile.model_error * kProfile.model_error + doubt * doubt * doubt * doubt,
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
  // Lines share blur, print and dirt: together they count as a few independent ones.
  const double share =
      std::min(1.0, kFrameless.independent / static_cast<double>(lines.size())) / 2;
  Evidence evidence;
  for (const ReadLine& line : lines) {
    const double weight = share / std::max(1.0, line.reading.alignment.cost_per_module);
    for (std::size_t i = 0; i < kDigitCount; ++i) {
      for (std::size_t d = 0; d < 10; ++d) {
        evidence.cost[i][d] +=
            weight * std::min(kFrameless.most_of_a_line, line.reading.extra_cost[i][d]);
      }
    }
    for (std::size_t i = 0; i < 6; ++i) {
      evidence.even_parity[i] +=
          weight * std::clamp(line.reading.even_parity_cost[i], -kFrameless.most_of_a_line,
                              kFrameless.most_of_a_line);
    }
  }
  return evidence;
}

// The most likely code and its probability among those that may exist.
struct CodeConsensus {
  Digits digits{};
  double probability = 0;
};

// What the evidence costs each symbol; no other characters than digits are compared.
CharacterCosts costs_of(const Evidence& evidence) {
  constexpr double kNever = 1e6;
  CharacterCosts costs{};
  for (std::size_t i = 0; i < kDigitCount; ++i) {
    costs.alone[i].fill(kNever);
    for (std::size_t d = 0; d < 10; ++d) costs.alone[i][d] = 2 * evidence.cost[i][d];
  }
  return costs;
}

// As for framed symbols (decoder/scan/decode.cpp, doubt_about): against the other codes that may
// exist and, with a small prior, all 10^12.
CodeConsensus consensus_of(const Evidence& evidence, const DecodeOptions& options) {
  constexpr double kAllSymbols = 1e12;
  const auto besides = [](double sum) { return std::max(0.0, sum - 1); };
  const std::span<const Digits> book = options.code_book;
  const CharacterCosts costs = costs_of(evidence);
  const BestSymbol best = best_of(costs, options);
  const double codes = book.empty() ? sum_of_codes(costs, best, schemes_of(options).front())
                                    : sum_of_codes(costs, best, book);
  const double code_count = book.empty() ? 1e11 : static_cast<double>(book.size());
  const double rivals = besides(codes) + kOdds.wrong_check * code_count / kAllSymbols *
                                             besides(sum_of_symbols(costs, best, {1, 0}));
  return {digits_of(best.characters), 1 / (1 + rivals)};
}

// True when three digits of the left half suit even parity: EAN-13 with a leading digit other
// than 0 (GS1 General Specifications 5.2.1.2.1) has that in just three.
bool may_be_ean13(const Evidence& evidence) {
  std::array<double, 6> costs = evidence.even_parity;
  std::ranges::sort(costs);
  return costs[0] + costs[1] + costs[2] < kFrameless.even_parity;
}

std::optional<RejectionReason> objection_to(const FramelessReading& symbol,
                                            const Evidence& evidence, const ReadOptions& options) {
  const Decoding& decoding = symbol.decoding;
  using enum RejectionReason;
  if (decoding.guards < kJudge.guards) return guard_pattern;
  if (decoding.fit.explained < kJudge.explained || decoding.worst_digit < kDecode.hopeless) {
    return element_widths;
  }
  if (std::abs(decoding.fit.image.growth) > kJudge.most_growth) return growth;
  if (decoding.digits != symbol.digits) return lines_disagree;
  if (symbol.confidence < options.min_confidence.value_or(kSureWithoutFrame) ||
      decoding.confidence < kFrameless.together) {
    return doubtful;
  }
  if (may_be_ean13(evidence)) return ean13;
  return std::nullopt;
}

// Aligns every line again to the common darkness of all lines.
std::vector<ReadLine> realigned(const RegionScan& scan, const Digits& digits) {
  std::vector<ReadLine> lines;
  for (const ReadLine& line : scan.lines) {
    const auto alignment =
        align_elastic(line.light, place_of(line.reading.alignment), scan.look->templates, digits);
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

// What a region's bars say, and the reason for not believing it.
struct ReadRegion {
  FramelessReading symbol;
  std::optional<RejectionReason> objection;
};

// Nothing where the bars do not look much like a symbol.
std::optional<ReadRegion> read_region(SampledLight& image, const BarRegion& region,
                                      const ReadOptions& options) {
  // Other regions are not worth a refusal in the report: enough blur explains any texture.
  auto first = first_line(image, region, Wanted::digits);
  if (!first) return std::nullopt;
  const RegionScan scan = scan_region(image, region, *std::move(first), Wanted::digits);
  DecodeOptions decode_options{options.check, options.code_book};
  if (!options.check && options.code_book.empty()) decode_options.check = CheckDigit::gs1;
  const Evidence evidence = evidence_of(scan.lines);
  const CodeConsensus consensus = consensus_of(evidence, decode_options);
  ReadRegion region_read;
  FramelessReading& symbol = region_read.symbol;
  symbol.profile = merged_profile(realigned(scan, consensus.digits));
  ImagingModel start;
  start.blur = scan.look->bars.blur;
  const auto decoding = decode_profile(symbol.profile, start, decode_options);
  if (!decoding || decoding->fit.explained < kJudge.explained ||
      decoding->fit.image.blur > kJudge.most_blur) {
    return std::nullopt;
  }
  symbol.decoding = *decoding;
  symbol.digits = consensus.digits;
  symbol.sum10_holds = has_check_digit(CheckDigit::sum10, symbol.digits);
  symbol.gs1_holds = has_check_digit(CheckDigit::gs1, symbol.digits);
  symbol.confidence = consensus.probability;
  symbol.bars = outline_of(scan);
  symbol.lines = line_ends(scan);
  symbol.module_px = length_of(symbol.bars) / kModuleCount;
  region_read.objection = objection_to(symbol, evidence, options);
  return region_read;
}

PixelPoint centre_of_bars(const FramelessReading& symbol) {
  return 0.5 * (symbol.bars[0] + symbol.bars[2]);
}

}  // namespace

FramelessResult read_frameless(SearchedImage& picture, const ReadOptions& options) {
  FramelessResult result;
  const auto is_read = [&](PixelPoint centre) {
    return std::ranges::any_of(
        result.read, [&](const FramelessReading& other) { return contains(other.bars, centre); });
  };
  const std::vector<BarRegion>& regions = picture.bars();
  for (std::size_t i = 0; i < std::min(regions.size(), kSearch.most_tries); ++i) {
    const BarRegion& region = regions[i];
    if (is_read(region.centre)) continue;
    auto read = read_region(picture.light, region, options);
    if (!read) continue;
    // Bars seen at two reductions of the image are the same.
    const PixelPoint centre = centre_of_bars(read->symbol);
    const auto same = [&](const FramelessRejection& other) {
      return contains(other.symbol.bars, centre);
    };
    if (!read->objection) {
      if (!is_read(centre)) result.read.push_back(std::move(read->symbol));
    } else if (std::ranges::none_of(result.rejected, same)) {
      result.rejected.push_back({*read->objection, std::move(read->symbol)});
    }
  }
  std::erase_if(result.rejected, [&](const FramelessRejection& rejection) {
    return is_read(centre_of_bars(rejection.symbol));
  });
  return result;
}

namespace {

// Whether the middle of a symbol's bars lies in a frame.
template <class Framed>
bool stands_in(const FramelessReading& symbol, const Framed& framed) {
  return contains(framed.corners, centre_of_bars(symbol));
}

// Whether a symbol is that of a tag whose code is read with more of it.
bool is_read(const FramelessReading& symbol, const ReadResult& result) {
  const auto holds = [&](const auto& framed) { return stands_in(symbol, framed); };
  return std::ranges::any_of(result.tags, holds) ||
         std::ranges::any_of(result.parts, [&](const PartReading& part) {
           return part.shows_all_bars && holds(part);
         });
}

// Whether a framed symbol was refused for a reason that makes a reading by the bars alone a guess
// too.
bool is_doubted(const Rejection& framed) {
  return framed.reason == RejectionReason::doubtful || framed.reason == RejectionReason::covered;
}

}  // namespace

ReadResult with_frameless(SearchedImage& picture, const ReadOptions& options, ReadResult result) {
  const bool wanted = options.frameless == Frameless::always ||
                      (options.frameless == Frameless::fallback && result.tags.empty());
  if (!wanted) return result;
  ReadOptions named = options;
  if (!options.likely_codes.empty()) named.code_book = options.likely_codes;
  FramelessResult& frameless = result.frameless;
  frameless = read_frameless(picture, named);
  std::erase_if(frameless.read,
                [&](const FramelessReading& symbol) { return is_read(symbol, result); });
  std::erase_if(frameless.rejected, [&](const FramelessRejection& rejection) {
    return is_read(rejection.symbol, result);
  });
  std::erase_if(frameless.read, [&](const FramelessReading& symbol) {
    const auto doubted = std::ranges::find_if(result.rejected, [&](const Rejection& framed) {
      return is_doubted(framed) && stands_in(symbol, framed);
    });
    if (doubted == result.rejected.end()) return false;
    frameless.rejected.push_back({doubted->reason, symbol, true});
    return true;
  });
  return result;
}

}  // namespace tagsmith::detail
