// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/explain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/reader/symbol_hypothesis.hpp"
#include "decoder/scan/explanation.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

double cost_of(const ScanProfile& profile, const std::vector<double>& expected) {
  double cost = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const double residual = profile[i].darkness - expected[i];
    cost += residual * residual / profile[i].variance;
  }
  return cost;
}

std::array<double, kDigitCount> margins_of(const ScanProfile& profile, const ImagingModel& image,
                                           const Digits& digits, double noise) {
  const double own = cost_of(profile, expected_darkness(image, digits, profile));
  std::array<double, kDigitCount> margins{};
  for (std::size_t i = 0; i < margins.size(); ++i) {
    double rival = std::numeric_limits<double>::infinity();
    for (std::uint8_t digit = 0; digit < 10; ++digit) {
      if (digit == digits[i]) continue;
      Digits other = digits;
      other[i] = digit;
      rival = std::min(rival, cost_of(profile, expected_darkness(image, other, profile)));
    }
    margins[i] = (rival - own) / 2 / noise / std::log(10.0);
  }
  return margins;
}

// What was seen of a symbol in a frame.
void add_symbol(const SymbolHypothesis& symbol, ExplainedSymbol& explained) {
  explained.digits = symbol.decoding.digits;
  explained.decoding = symbol.decoding;
  explained.module_px = symbol.profile.module_px;
  explained.confidence = symbol.decoding.confidence;
  explained.profile =
      symbol.decoding.upside_down ? turned(symbol.profile.bins) : symbol.profile.bins;
  const SymbolLayout& layout = symbol.layout;
  const FrameHomography image_from_frame(symbol.frame.corners, symbol.frame.lens);
  for (const double v : {layout.bars_top, 0.5, layout.bars_bottom}) {
    explained.lines.push_back({image_from_frame(layout.width_share(0), v),
                               image_from_frame(layout.width_share(kModuleCount), v)});
  }
  for (int i = 0; i < kDigitCount; ++i) {
    const double middle = first_module_of_digit(i) + kModulesPerDigit / 2.0;
    explained.digit_places[static_cast<std::size_t>(i)] =
        image_from_frame(layout.width_share(middle), 0.5);
  }
}

ExplainedSymbol explain_reading(const Reading& reading) {
  ExplainedSymbol explained;
  if (reading.symbol) add_symbol(*reading.symbol, explained);
  explained.digits = reading.digits;
  explained.proposer = reading.proposer;
  explained.outline = reading.corners;
  explained.module_px = reading.module_px;
  explained.confidence = reading.confidence;
  return explained;
}

ExplainedSymbol explain_rejection(const Rejection& rejection) {
  ExplainedSymbol explained;
  if (rejection.symbol) add_symbol(*rejection.symbol, explained);
  explained.proposer = rejection.proposer;
  explained.outline = rejection.corners;
  explained.refusal = describe_measured(rejection);
  return explained;
}

ExplainedSymbol explain_frameless(const FramelessReading& bars) {
  ExplainedSymbol symbol;
  symbol.digits = bars.digits;
  symbol.framed = false;
  symbol.outline = bars.bars;
  symbol.lines = bars.lines;
  symbol.profile = bars.profile;
  symbol.decoding = bars.decoding;
  symbol.module_px = bars.module_px;
  symbol.confidence = bars.confidence;
  const Homography image_from_frame = homography_to(bars.bars);
  for (int i = 0; i < kDigitCount; ++i) {
    const double middle = first_module_of_digit(i) + kModulesPerDigit / 2.0;
    symbol.digit_places[static_cast<std::size_t>(i)] = image_from_frame(middle / kModuleCount, 0.5);
  }
  return symbol;
}

void add_fit(ExplainedSymbol& symbol) {
  symbol.expected = expected_darkness(symbol.decoding.fit.image, symbol.digits, symbol.profile);
  symbol.margins =
      margins_of(symbol.profile, symbol.decoding.fit.image, symbol.digits, symbol.decoding.noise);
}

}  // namespace

Explanation explain(const ReadResult& result) {
  Explanation explanation;
  explanation.passed_over = result.passed_over;
  std::vector<ExplainedSymbol>& symbols = explanation.symbols;
  for (const Reading& reading : result.tags) symbols.push_back(explain_reading(reading));
  for (const Rejection& rejection : result.rejected) {
    symbols.push_back(explain_rejection(rejection));
  }
  for (const FramelessReading& bars : result.frameless.read) {
    symbols.push_back(explain_frameless(bars));
  }
  for (const FramelessRejection& rejection : result.frameless.rejected) {
    symbols.push_back(explain_frameless(rejection.symbol));
    symbols.back().refusal = describe(rejection);
  }
  for (ExplainedSymbol& symbol : symbols) add_fit(symbol);
  return explanation;
}

}  // namespace tagsmith::detail
