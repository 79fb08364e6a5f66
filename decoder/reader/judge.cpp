// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "decoder/reader/bar_ends.hpp"
#include "decoder/reader/occluders.hpp"
#include "decoder/reader/placed_corners.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/scan/decode.hpp"
#include "decoder/scan/tuning.hpp"

namespace tagsmith::detail {
namespace {

// Whether the stroke of a side that was assumed hidden is visible elsewhere.
bool has_misplaced_side(const GrayView& image, const SymbolHypothesis& symbol) {
  const auto is_misplaced = [&](std::size_t side) {
    if (symbol.frame.shown[side]) return false;
    const BarField field = bar_field(corners_of(symbol), symbol.layout, symbol.frame.lens);
    return is_stroke_beyond(image, field, symbol.layout, side);
  };
  return is_misplaced(0) || is_misplaced(2);
}

// The reading that reports a believed symbol.
Reading reading_from(const GrayView& image, SymbolHypothesis symbol, const BothEnds& ends,
                     ReadingMethod method) {
  Reading reading;
  reading.digits = symbol.decoding.digits;
  reading.sum10_holds = has_check_digit(CheckDigit::sum10, reading.digits);
  reading.gs1_holds = has_check_digit(CheckDigit::gs1, reading.digits);
  const PlacedCorners placed = placed_by_frame_and_bars(image, symbol, ends);
  reading.corners = placed.corners;
  reading.corner_covariance = placed.covariance;
  reading.module_px = symbol.profile.module_px;
  reading.confidence = symbol.decoding.confidence;
  reading.method = method;
  reading.symbol = std::move(symbol);
  reading.symbol->rows.reset();
  return reading;
}

}  // namespace

std::optional<Objection> objection_to(const Decoding& decoding, const ReadOptions& options) {
  const SymbolFit& fit = decoding.fit;
  const bool with_book = !options.code_book.empty();
  const double sure = options.min_confidence.value_or(with_book ? kSureWithBook : kSureInFrame);
  using enum RejectionReason;
  if (decoding.guards < kJudge.guards) {
    return Objection{guard_pattern, decoding.guards, kJudge.guards};
  }
  if (fit.explained < kJudge.explained) {
    return Objection{element_widths, fit.explained, kJudge.explained};
  }
  if (decoding.worst_digit < kDecode.hopeless) {
    return Objection{element_widths, decoding.worst_digit, kDecode.hopeless};
  }
  if (std::abs(fit.image.growth) > kJudge.most_growth) {
    return Objection{growth, std::abs(fit.image.growth), kJudge.most_growth};
  }
  if (!with_book && fit.image.blur > kJudge.most_blur)
    return Objection{blur, fit.image.blur, kJudge.most_blur};
  if (decoding.confidence < sure) return Objection{doubtful, decoding.confidence, sure};
  return std::nullopt;
}

bool halves_contradict(const RobustProfile& rows, const Decoding& decoding) {
  const auto contradicts = [&](const HeightShare& half) {
    return log_odds_of_another(rows.of_agreeing_rows(half).bins, decoding) > kJudge.clearly;
  };
  return contradicts({0, 0.5}) || contradicts({0.5, 1});
}

std::optional<Objection> objection_to_quick(const GrayView& image, const SymbolHypothesis& symbol,
                                            const ReadOptions& options) {
  const Decoding& decoding = symbol.decoding;
  if (const auto by_itself = objection_to(decoding, options)) return by_itself;
  const Objection covered{RejectionReason::covered};
  if (!strips_along_bars(image, symbol.frame, symbol.layout).empty()) {
    return covered;
  }
  if (is_beyond_doubt(decoding)) return std::nullopt;
  const auto rows = rows_of(image, turned_to(symbol.frame, decoding.upside_down ? 2 : 0), symbol);
  return halves_contradict(*rows, decoding) ? std::optional(covered) : std::nullopt;
}

std::optional<SymbolHypothesis> believed_hypothesis(const GrayView& image,
                                                    const RefinedFrame& frame,
                                                    const ReadOptions& options, bool quickly_too) {
  if (quickly_too) {
    auto quick = quick_hypothesis(image, frame, options);
    if (quick && !objection_to_quick(image, *quick, options)) return quick;
  }
  // What covers a side need not cover the bars, too.
  const bool whole = std::ranges::all_of(frame.shown, std::identity{});
  const double sure = options.min_confidence.value_or(whole ? kSureIfCovered : 0);
  for (const AddedLight added : {AddedLight::even, AddedLight::slanted}) {
    auto careful = careful_hypothesis(image, frame, options, added);
    if (!careful || careful->decoding.fit.explained < kJudge.like_symbol) return std::nullopt;
    if (!objection_to(careful->decoding, options) && careful->decoding.confidence >= sure) {
      return careful;
    }
  }
  return std::nullopt;
}

bool is_symbol_like(const SymbolHypothesis& symbol) {
  const Decoding& decoding = symbol.decoding;
  return decoding.fit.explained > kJudge.like_symbol && decoding.guards > kJudge.like_symbol &&
         std::abs(decoding.fit.image.growth) <= kJudge.most_growth;
}

namespace {

// Whether bars are left of what the decoding says. Half the elements of a symbol are one module
// wide; blurred beyond what can be read, any edge fits as well as bars do, so that only a good fit
// is evidence.
bool has_bars(const Decoding& decoding) {
  constexpr double kVanished = 1.5;  // modules of growth: an element's, and what blur adds to it
  const SymbolFit& fit = decoding.fit;
  if (std::abs(fit.image.growth) > kVanished) return false;
  return fit.image.blur <= kJudge.most_blur ||
         (fit.explained >= kJudge.explained && decoding.guards >= kJudge.guards);
}

}  // namespace

bool suits_its_frame(const SymbolHypothesis& symbol) {
  constexpr double kLeastModule = 0.3;  // pixels; of narrower ones nothing is seen
  const double module = symbol.profile.module_px;
  if (module < kLeastModule || std::abs(symbol.decoding.fit.image.growth) > 1) return false;
  if (is_symbol_like(symbol)) return true;
  const auto alike = [](double a, double b) { return std::abs(std::log(a / b)) < 1; };
  const ImagingModel& bars = symbol.decoding.fit.image;
  const auto as_sharp_as = [&](std::size_t side) {
    return alike(bars.blur * module, symbol.frame.sides[side].blur_px);
  };
  return alike(bars.black - bars.white, 1) && (as_sharp_as(1) || as_sharp_as(3));
}

bool may_be_symbol(const SymbolHypothesis& symbol) {
  constexpr double kHalfExplained = 0.5;  // what glare leaves of a tag, and hardly a wall shows
  const Decoding& decoding = symbol.decoding;
  if (!has_bars(decoding)) return false;
  const ImagingModel& image = decoding.fit.image;
  const bool is_like_one =
      decoding.fit.explained > kHalfExplained || decoding.guards > kJudge.like_symbol;
  return is_symbol_like(symbol) || (is_like_one && image.black - image.white > kProfile.odd);
}

std::optional<SymbolHypothesis> stranger_to_book(const GrayView& image, const RefinedFrame& frame,
                                                 const ReadOptions& options) {
  ReadOptions alone;
  alone.check = options.check;
  alone.layouts = options.layouts;
  auto symbol = quick_hypothesis(image, frame, alone);
  if (!symbol || objection_to(symbol->decoding, alone)) return std::nullopt;
  const auto& book = options.code_book;
  const bool is_known = std::ranges::find(book, symbol->decoding.digits) != book.end();
  return is_known ? std::nullopt : std::move(symbol);
}

std::optional<Reading> reading_where_bars_end(const GrayView& image, const SymbolHypothesis& symbol,
                                              const ReadOptions& options, ReadingMethod method) {
  const RefinedFrame& frame = symbol.frame;
  const BothEnds ends = bar_ends_of(image, symbol);
  const EndsVerdict verdict = judge_by_bar_ends(image, ends, corners_of(symbol), symbol.layout);
  const bool whole = std::ranges::all_of(frame.shown, std::identity{});
  if (verdict.kind == EndsVerdict::odd) return std::nullopt;
  // Among shadows other straight edges are near.
  const bool may_differ = whole && !symbol.in_shadow;
  if (verdict.kind == EndsVerdict::other_layout && !may_differ) return std::nullopt;
  if (verdict.kind != EndsVerdict::hidden) {
    if (has_misplaced_side(image, symbol)) return std::nullopt;
    return reading_from(image, symbol, ends, method);
  }
  std::array<bool, 4> shown{};
  for (std::size_t i = 0; i < 4; ++i) {
    shown[i] = frame.shown[i] && i != verdict.side;
  }
  const auto completed = refine_shown_sides(image, verdict.corners, shown, verdict.sigma_px,
                                            frame.lens, symbol.layout.frame, frame.was_sharpened);
  if (!completed) return std::nullopt;
  const auto again = believed_hypothesis(image, *completed, options, true);
  if (!again || again->decoding.digits != symbol.decoding.digits) return std::nullopt;
  if (has_misplaced_side(image, *again)) return std::nullopt;
  return reading_from(image, *again, bar_ends_of(image, *again), ReadingMethod::partly_covered);
}

Rejection rejection_of(SymbolHypothesis symbol, const Objection& objection) {
  Rejection rejection;
  rejection.reason = objection.reason;
  rejection.corners = corners_of(symbol);
  rejection.measured = objection.measured;
  rejection.limit = objection.limit;
  rejection.symbol = std::move(symbol);
  rejection.symbol->rows.reset();
  return rejection;
}

}  // namespace tagsmith::detail
