// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/explain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "decoder/feature_frame/quad.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/reader/frameless.hpp"
#include "decoder/reader/symbol_profile.hpp"
#include "decoder/scan/explained.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

double cost_of(const ScanProfile& profile, const std::vector<double>& expected) {
  double cost = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const double residual = profile[i].darkness - expected[i];
    cost += residual * residual / profile[i].variance;
  }
  return cost;
}

std::array<double, kDigitCount> margins_of(const ScanProfile& profile, const SymbolImage& image,
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

// Profile, fit and margins of digits inside a frame whose corners are known, P first.
std::optional<ExplainedSymbol> explain_framed(const GrayView& image, const FrameCorners& corners,
                                              const std::optional<Digits>& digits,
                                              const SymbolLayout& layout,
                                              const ReadOptions& options) {
  LensGuess lens;
  if (options.camera) lens.known = LensBend(*options.camera);
  const Result<RefinedFrame> frame = refine_frame(image, corners, lens);
  if (!frame) return std::nullopt;
  SymbolProfile profile = profile_symbol(image, *frame, 0, layout);
  SymbolImage start;
  start.blur = std::clamp(profile.blur, 0.1, 3.0);
  DecodeOptions decode_options{options.check, options.code_book};
  if (digits) decode_options = {std::nullopt, std::span(&*digits, 1)};
  const auto decoding = decode_profile(profile.bins, start, decode_options);
  // What is upside down from this corner on is upright from the opposite one.
  if (!decoding || decoding->upside_down) return std::nullopt;
  ExplainedSymbol symbol;
  symbol.digits = decoding->digits;
  symbol.outline = frame->corners;
  symbol.decoding = *decoding;
  symbol.module_px = profile.module_px;
  symbol.profile = std::move(profile.bins);
  const FrameMap image_from_unit(frame->corners, frame->lens);
  const double modules = kModuleCount + 2 * layout.quiet_zone_modules;
  const auto u_of = [&](double module) { return (layout.quiet_zone_modules + module) / modules; };
  for (const double v : {layout.bars_top, 0.5, layout.bars_bottom}) {
    symbol.lines.push_back({image_from_unit(u_of(0), v), image_from_unit(u_of(kModuleCount), v)});
  }
  for (int i = 0; i < kDigitCount; ++i) {
    const double middle = first_module_of_digit(i) + kModulesPerDigit / 2.0;
    symbol.digit_places[static_cast<std::size_t>(i)] = image_from_unit(u_of(middle), 0.5);
  }
  return symbol;
}

void add_fit(ExplainedSymbol& symbol) {
  symbol.expected = expected_darkness(symbol.decoding.fit.image, symbol.digits, symbol.profile);
  symbol.margins =
      margins_of(symbol.profile, symbol.decoding.fit.image, symbol.digits, symbol.decoding.noise);
}

bool explains_more(const std::optional<ExplainedSymbol>& symbol,
                   const std::optional<ExplainedSymbol>& other) {
  if (!symbol) return false;
  return !other || symbol->decoding.fit.explained > other->decoding.fit.explained;
}

ExplainedSymbol explain_reading(const GrayView& image, const Reading& reading,
                                const ReadOptions& options) {
  std::optional<ExplainedSymbol> best;
  for (const SymbolLayout& layout : options.layouts) {
    auto symbol = explain_framed(image, reading.corners, reading.digits, layout, options);
    if (explains_more(symbol, best)) best = std::move(symbol);
  }
  if (!best) {
    best.emplace();
    best->digits = reading.digits;
    best->outline = reading.corners;
  }
  best->confidence = reading.confidence;
  best->module_px = reading.module_px;
  return *best;
}

// The best guess over layouts and ways up.
ExplainedSymbol explain_rejection(const GrayView& image, const Rejection& rejection,
                                  const ReadOptions& options) {
  std::optional<ExplainedSymbol> best;
  for (std::size_t turn = 0; turn < 4; ++turn) {
    FrameCorners corners = rejection.corners;
    std::ranges::rotate(corners, corners.begin() + static_cast<std::ptrdiff_t>(turn));
    for (const SymbolLayout& layout : options.layouts) {
      auto symbol = explain_framed(image, corners, std::nullopt, layout, options);
      if (explains_more(symbol, best)) best = std::move(symbol);
    }
  }
  if (!best) best.emplace().outline = rejection.corners;
  best->refusal = rejection.reason;
  best->confidence = best->decoding.confidence;
  return *best;
}

ExplainedSymbol explain_frameless(const FramelessTrace& trace) {
  ExplainedSymbol symbol;
  symbol.digits = trace.digits;
  symbol.refusal = trace.objection;
  symbol.framed = false;
  symbol.outline = trace.bars;
  symbol.lines = trace.lines;
  symbol.profile = trace.profile;
  symbol.decoding = trace.decoding;
  symbol.module_px = trace.module_px;
  symbol.confidence = trace.confidence;
  const Homography image_from_unit = homography_to(trace.bars);
  for (int i = 0; i < kDigitCount; ++i) {
    const double middle = first_module_of_digit(i) + kModulesPerDigit / 2.0;
    symbol.digit_places[static_cast<std::size_t>(i)] = image_from_unit(middle / kModuleCount, 0.5);
  }
  return symbol;
}

}  // namespace

Explanation explain(const GrayView& image, const ReadOptions& options, const ReadResult& result) {
  Explanation explanation;
  explanation.passed_over = result.passed_over;
  for (const Reading& reading : result.tags) {
    explanation.symbols.push_back(explain_reading(image, reading, options));
  }
  for (const Rejection& rejection : result.rejected) {
    explanation.symbols.push_back(explain_rejection(image, rejection, options));
  }
  if (!result.frameless.read.empty() || !result.frameless.rejected.empty()) {
    PictureBars bars(image);
    for (const FramelessTrace& trace : trace_frameless(bars, options)) {
      explanation.symbols.push_back(explain_frameless(trace));
    }
  }
  for (ExplainedSymbol& symbol : explanation.symbols) add_fit(symbol);
  return explanation;
}

}  // namespace tagsmith
