// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/attempt.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "decoder/feature_frame/bar_direction.hpp"
#include "decoder/feature_frame/lens_bend.hpp"
#include "decoder/feature_frame/quad.hpp"
#include "decoder/reader/cover_strips.hpp"
#include "decoder/reader/covered_profile.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

// The corners that may be P's: the symbol runs the way in which the grey level changes; both ways
// when that is not clear. Upside down is left to the symbol.
std::vector<std::size_t> possible_first_corners(const GrayView& image, const Quad& quad) {
  constexpr double kClear = 1.5;
  const BarSteps steps = bar_steps(image, quad);
  if (steps.along > kClear * steps.across) return {0};
  if (steps.across > kClear * steps.along) return {1};
  return {0, 1};
}

// The best explained attempt along the symbol direction(s) that are possible. `to_profile` is
// profile_symbol or CoveredSymbols::profile.
template <class ToProfile>
std::optional<Attempt> best_attempt(const GrayView& image, const RefinedFrame& frame,
                                    const ReadOptions& options, const ToProfile& to_profile) {
  const DecodeOptions decode_options{options.check, options.code_book};
  std::optional<Attempt> best;
  const auto attempt = [&](std::size_t first_corner, const SymbolLayout& layout) {
    const SymbolProfile profile = to_profile(image, frame, first_corner, layout);
    SymbolImage start;
    start.blur = std::clamp(profile.blur, 0.1, 3.0);
    const auto decoding = decode_profile(profile.bins, start, decode_options);
    if (!decoding) return;
    if (best && decoding->fit.explained <= best->decoding.fit.explained) return;
    best =
        Attempt{*decoding, (first_corner + (decoding->upside_down ? 2 : 0)) % 4, profile, layout};
  };
  for (const std::size_t first_corner : possible_first_corners(image, frame.corners)) {
    for (const SymbolLayout& layout : options.layouts) attempt(first_corner, layout);
  }
  return best;
}

// What speaks against believing the attempt, or nothing.
std::optional<std::string> objection(const Attempt& attempt, const ReadOptions& options) {
  // A symbol of ours explains 95 % and more of its profile when it can be read at all; the product
  // codes and random stripes of the test pictures reach 88 %.
  constexpr double kLeastExplained = 0.9;
  // Right digits on the ray-traced photos: 0.82 and more; digits with an edge a module off: 0.5.
  constexpr double kLeastDigit = 0.75;
  constexpr double kLeastGuards = 0.8;
  constexpr double kLeastKept = 0.7;
  constexpr double kMostGrowth = 0.7;  // modules; beyond, narrow elements vanish
  // Modules; beyond, digits differ by what is left in the tails of the point spread, of which
  // nothing is known.
  constexpr double kMostBlur = 2.2;
  const Decoding& decoding = attempt.decoding;
  const bool with_book = !options.code_book.empty();
  if (decoding.guards < kLeastGuards) return "guard pattern";
  if (decoding.fit.explained < kLeastExplained || decoding.worst_digit < kLeastDigit) {
    return "element widths";
  }
  if (decoding.fit.kept < kLeastKept) return kCoveredReason;
  if (std::abs(decoding.fit.image.growth) > kMostGrowth) return "bars grown or shrunk";
  if (!with_book && decoding.fit.image.blur > kMostBlur) return "too blurred";
  const double sure = with_book ? kSureWithBook : kSureInFrame;
  if (decoding.confidence < options.min_confidence.value_or(sure)) return kDoubtfulReason;
  return std::nullopt;
}

// Whether the upper or the lower half of the bars' height shows another symbol clearly: something
// lies on part of the height, and what shows beside it may be no digit. Symbols that are beyond
// doubt by their whole height are not asked.
// Why: docs/decisions/0004-occlusion.md.
bool halves_contradict(const GrayView& image, const RefinedFrame& frame, const Attempt& attempt) {
  constexpr double kBeyondDoubt = 1e-8;
  constexpr double kClearly = 10;  // logarithm of the likelihood ratio
  const Decoding& decoding = attempt.decoding;
  if (1 - decoding.confidence < kBeyondDoubt) return false;
  const std::size_t first = (attempt.first_corner + (decoding.upside_down ? 2 : 0)) % 4;
  const double middle = (attempt.layout.bars_top + attempt.layout.bars_bottom) / 2;
  SymbolLayout upper = attempt.layout, lower = attempt.layout;
  upper.bars_bottom = lower.bars_top = middle;
  const auto contradicts = [&](const SymbolLayout& half) {
    const SymbolProfile profile = profile_symbol(image, frame, first, half);
    return log_odds_of_another(profile.bins, decoding) > kClearly;
  };
  return contradicts(upper) || contradicts(lower);
}

// Whether a symbol shows too little for its covered digits to be more than guesses.
bool too_little_shown(const SymbolProfile& profile) {
  constexpr double kMostHidden = 0.25;  // of the places
  constexpr double kSaysNothing = 1;    // variance
  const auto hidden = std::ranges::count_if(
      profile.bins, [](const ScanBin& bin) { return bin.variance > kSaysNothing; });
  return static_cast<double>(hidden) > kMostHidden * static_cast<double>(profile.bins.size());
}

}  // namespace

std::optional<Attempt> attempt_quickly(const GrayView& image, const RefinedFrame& frame,
                                       const ReadOptions& options) {
  return best_attempt(image, frame, options, profile_symbol);
}

namespace {

// What a frame holds as it may stand there, each seen once.
class CoveredSymbols {
 public:
  SymbolProfile profile(const GrayView& image, const RefinedFrame& frame, std::size_t first_corner,
                        const SymbolLayout& layout, AddedLight added) {
    const auto seen = std::ranges::find_if(seen_, [&](const Seen& other) {
      return other.first_corner == first_corner && other.layout == layout;
    });
    if (seen != seen_.end()) return seen->symbol.profile(added);
    seen_.push_back({first_corner, layout, CoveredSymbol(image, frame, first_corner, layout)});
    return seen_.back().symbol.profile(added);
  }

 private:
  struct Seen {
    std::size_t first_corner;
    SymbolLayout layout;
    CoveredSymbol symbol;
  };

  std::vector<Seen> seen_;
};

// As attempt_quickly, by the careful profile of the light; `symbols` keeps what is seen of the
// frame.
std::optional<Attempt> attempt_carefully(const GrayView& image, const RefinedFrame& frame,
                                         const ReadOptions& options, AddedLight added,
                                         CoveredSymbols& symbols) {
  return best_attempt(
      image, frame, options,
      [&](const GrayView& in, const RefinedFrame& of, std::size_t first,
          const SymbolLayout& layout) { return symbols.profile(in, of, first, layout, added); });
}

}  // namespace

std::optional<Attempt> attempt_both_ways(const GrayView& image, const RefinedFrame& frame,
                                         const ReadOptions& options) {
  auto quick = attempt_quickly(image, frame, options);
  CoveredSymbols symbols;
  auto careful = attempt_carefully(image, frame, options, AddedLight::even, symbols);
  if (!careful || (quick && quick->decoding.fit.explained > careful->decoding.fit.explained)) {
    return quick;
  }
  return careful;
}

std::optional<std::string> objection_to_quick(const GrayView& image, const RefinedFrame& frame,
                                              const Attempt& attempt, const ReadOptions& options) {
  const auto reason = objection(attempt, options);
  if (reason) return reason;
  const auto [corners, sides] = turned_to(frame, attempt.first_corner);
  const double stroke = stroke_share(corners, (sides[0].stroke_px + sides[2].stroke_px) / 2);
  const auto strips =
      strips_along_bars(image, FrameMap(corners, frame.lens), attempt.layout, stroke);
  if (!strips.empty() || halves_contradict(image, frame, attempt)) return kCoveredReason;
  return std::nullopt;
}

std::optional<Attempt> believed_attempt(const GrayView& image, const RefinedFrame& frame,
                                        const ReadOptions& options, bool quickly_too) {
  if (quickly_too) {
    const auto quick = attempt_quickly(image, frame, options);
    if (quick && !objection_to_quick(image, frame, *quick, options)) return quick;
  }
  // Symbols that were read with slanted light alone had 0.83 explained with even light
  // (`./dev bench troubled`).
  constexpr double kSymbolLike = 0.7;
  CoveredSymbols symbols;
  for (const AddedLight added : {AddedLight::even, AddedLight::slanted}) {
    const auto careful = attempt_carefully(image, frame, options, added, symbols);
    if (!careful || careful->decoding.fit.explained < kSymbolLike) return std::nullopt;
    if (!objection(*careful, options) && !too_little_shown(careful->profile)) return careful;
  }
  return std::nullopt;
}

// Covered tags that were read carefully showed more: 0.8 and 0.7 (`./dev bench troubled`); other
// plates less, or no guard patterns at all.
bool is_symbol_like(const Attempt& attempt) {
  constexpr double kLeastExplained = 0.6;
  constexpr double kLeastGuards = 0.5;
  return attempt.decoding.fit.explained > kLeastExplained && attempt.decoding.guards > kLeastGuards;
}

std::optional<std::string> stranger_to_book(const GrayView& image, const RefinedFrame& frame,
                                            const ReadOptions& options) {
  ReadOptions alone;
  alone.check = options.check;
  alone.layouts = options.layouts;
  const auto attempt = attempt_quickly(image, frame, alone);
  if (!attempt || objection(*attempt, alone)) return std::nullopt;
  const Digits& digits = attempt->decoding.digits;
  if (std::ranges::find(options.code_book, digits) != options.code_book.end()) return std::nullopt;
  return "the digits " + to_string(digits) + " are in none of the given surveys";
}

FrameCorners corners_by_bars(const RefinedFrame& frame, const Attempt& attempt) {
  const FrameCorners corners = turned_to(frame, attempt.first_corner).corners;
  const SymbolImage& image = attempt.decoding.fit.image;
  const double quiet = attempt.layout.quiet_zone_modules;
  const auto u_of = [&](double module) {
    const double from_middle = module - kModuleCount / 2.0;
    const double t = 2 * from_middle / kModuleCount;
    const double seen = module + image.shift + image.stretch * from_middle + image.bend * t * t;
    return (quiet + seen) / (kModuleCount + 2 * quiet);
  };
  const double left = u_of(-quiet), right = u_of(kModuleCount + quiet);
  const FrameMap map(corners, frame.lens);
  return {map(left, 0), map(right, 0), map(right, 1), map(left, 1)};
}

FrameCorners corners_of(const RefinedFrame& frame, const Attempt& attempt) {
  const double growth_px = attempt.decoding.fit.image.growth * attempt.profile.module_px;
  const Quad quad = widened(frame.corners, growth_px / 2);
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4; ++i) corners[i] = quad[(attempt.first_corner + i) % 4];
  // The bars say better where a hidden side is than what said it before.
  const FrameCorners by_bars = corners_by_bars(frame, attempt);
  if (!frame.shown[(attempt.first_corner + 1) % 4]) {
    corners[1] = by_bars[1];
    corners[2] = by_bars[2];
  }
  if (!frame.shown[(attempt.first_corner + 3) % 4]) {
    corners[3] = by_bars[3];
    corners[0] = by_bars[0];
  }
  return corners;
}

Reading reading_from(const RefinedFrame& frame, const Attempt& attempt, const char* method) {
  Reading reading;
  reading.digits = attempt.decoding.digits;
  reading.sum10_holds = has_check_digit(CheckDigit::sum10, reading.digits);
  reading.gs1_holds = has_check_digit(CheckDigit::gs1, reading.digits);
  reading.corners = corners_of(frame, attempt);
  reading.corner_covariance = turned(corner_covariance(frame), attempt.first_corner);
  reading.module_px = attempt.profile.module_px;
  reading.confidence = attempt.decoding.confidence;
  reading.method = method;
  return reading;
}

double module_across(const Quad& frame) {
  const double one = (distance(frame[0], frame[1]) + distance(frame[2], frame[3])) / 2;
  const double other = (distance(frame[1], frame[2]) + distance(frame[3], frame[0])) / 2;
  return std::max(one, other) / (kModuleCount + 2 * SymbolLayout{}.quiet_zone_modules);
}

BarRegion bars_inside(const GrayView& image, const Quad& quad) {
  const std::size_t first = possible_first_corners(image, quad).front();
  const Homography map =
      homography_to({quad[first], quad[first + 1], quad[(first + 2) % 4], quad[(first + 3) % 4]});
  const SymbolLayout layout;
  const double margin = layout.quiet_zone_modules / (kModuleCount + 2 * layout.quiet_zone_modules);
  const PixelPoint left = map(margin, 0.5), right = map(1 - margin, 0.5);
  BarRegion region;
  region.centre = 0.5 * (left + right);
  region.length = distance(left, right);
  region.across = 1 / region.length * (right - left);
  region.height = distance(map(0.5, layout.bars_top), map(0.5, layout.bars_bottom));
  return region;
}

}  // namespace tagsmith
