// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/symbol_hypothesis.hpp"

#include <algorithm>
#include <utility>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/feature_frame/tuning.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/reader/uneven_light.hpp"
#include "decoder/scan/decode.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// The best explained hypothesis along the symbol direction(s) that are possible. `profile_of` gives
// the profile of the rows from a first corner on.
template <class ProfileOf>
std::optional<SymbolHypothesis> best_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                const ReadOptions& options, bool evened,
                                                const ProfileOf& profile_of) {
  const DecodeOptions decode_options{options.check, options.code_book};
  std::optional<SymbolHypothesis> best;
  const auto consider = [&](std::size_t first_corner, const SymbolLayout& layout) {
    auto rows = std::make_shared<const RobustProfile>(image, turned_to(frame, first_corner), layout,
                                                      evened);
    SymbolProfile profile = profile_of(*rows);
    ImagingModel start;
    start.blur = std::clamp(profile.blur, 0.1, 3.0);
    start.pixel = profile.pixel;
    const auto decoding = decode_profile(profile.bins, start, decode_options);
    if (!decoding) return;
    if (best && decoding->fit.explained <= best->decoding.fit.explained) return;
    best = SymbolHypothesis{turned_to(frame, (first_corner + (decoding->upside_down ? 2 : 0)) % 4),
                            layout, std::move(profile), *decoding};
    best->rows = std::move(rows);
  };
  for (const std::size_t first_corner : possible_first_corners(image, frame.corners)) {
    for (const SymbolLayout& layout : options.layouts) consider(first_corner, layout);
  }
  return best;
}

// By how many pixels the frame's strokes are thicker than the layout says, if they are thin enough
// for both of their edges to be fitted.
std::vector<double> stroke_growths(const SymbolHypothesis& symbol) {
  const Quad& corners = symbol.frame.corners;
  const FrameHomography map(corners, symbol.frame.lens);
  const FrameShape& shape = symbol.layout.frame;
  const double down = shape.stroke / shape.height, across = shape.stroke / shape.length;
  // Of each side, where the outer edge runs beside its begin and its end.
  const Quad begins{map(0, -down), map(1 + across, 0), map(1, 1 + down), map(-across, 1)};
  const Quad ends{map(1, -down), map(1 + across, 1), map(0, 1 + down), map(-across, 0)};
  std::vector<double> growths;
  for (std::size_t i = 0; i < 4; ++i) {
    const SideLine side = side_of(corners, i, shape);
    const double nominal =
        (dot(begins[i] - side.begin, side.outward) + dot(ends[i] - side.end, side.outward)) / 2;
    // The fit looks a little beyond the outer edge of a stroke whose thickness follows from the
    // side's proportions.
    const bool is_seen =
        symbol.frame.shown[i] && side.stroke < kSharpening.thin_stroke && nominal < side.stroke + 1;
    if (is_seen) growths.push_back(symbol.frame.sides[i].stroke_px - nominal);
  }
  return growths;
}

}  // namespace

std::vector<std::size_t> possible_first_corners(const GrayView& image, const Quad& quad) {
  const BarSteps steps = bar_steps(image, quad);
  if (steps.along > kSearch.clear_direction * steps.across) return {0};
  if (steps.across > kSearch.clear_direction * steps.along) return {1};
  return {0, 1};
}

std::shared_ptr<const RobustProfile> rows_of(const GrayView& image, const RefinedFrame& frame,
                                             const SymbolHypothesis& symbol) {
  const bool evened = symbol.profile.is_evened;
  if (symbol.rows && symbol.rows->is_of(image, frame, symbol.layout, evened)) return symbol.rows;
  return std::make_shared<RobustProfile>(image, frame, symbol.layout, evened);
}

bool is_beyond_doubt(const Decoding& decoding) {
  return 1 - decoding.confidence < kJudge.beyond_doubt;
}

namespace {

template <class ProfileOf>
std::optional<SymbolHypothesis> in_best_light(const GrayView& image, const RefinedFrame& frame,
                                              const ReadOptions& options,
                                              const ProfileOf& profile_of) {
  auto as_seen = best_hypothesis(image, frame, options, false, profile_of);
  const auto explained = [](const auto& symbol) { return symbol->decoding.fit.explained; };
  // No other light could explain more of it.
  if (as_seen && explained(as_seen) > kJudge.explained && is_beyond_doubt(as_seen->decoding)) {
    return as_seen;
  }
  const std::size_t first = possible_first_corners(image, frame.corners).front();
  if (!is_unevenly_lit(image, turned_to(frame, first), options.layouts.front())) return as_seen;
  auto evened = best_hypothesis(image, frame, options, true, profile_of);
  auto& better = evened && (!as_seen || explained(evened) > explained(as_seen)) ? evened : as_seen;
  if (better) better->in_shadow = true;
  return better;
}

}  // namespace

std::optional<SymbolHypothesis> quick_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                 const ReadOptions& options) {
  return in_best_light(image, frame, options,
                       [](const RobustProfile& rows) { return rows.of_agreeing_rows(); });
}

std::optional<SymbolHypothesis> careful_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                   const ReadOptions& options, AddedLight added) {
  return in_best_light(image, frame, options, [added](const RobustProfile& rows) {
    return rows.of_all_rows(rows.rows_in_sight(), added);
  });
}

std::optional<SymbolHypothesis> better_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                  const ReadOptions& options) {
  auto quick = quick_hypothesis(image, frame, options);
  auto careful = careful_hypothesis(image, frame, options, AddedLight::even);
  if (!careful || (quick && quick->decoding.fit.explained > careful->decoding.fit.explained)) {
    return quick;
  }
  return careful;
}

FrameCorners corners_by_bars(const SymbolHypothesis& symbol) {
  const ImagingModel& image = symbol.decoding.fit.image;
  const SymbolLayout& layout = symbol.layout;
  const double quiet = layout.quiet_zone_modules;
  const double left = layout.width_share(image.place_of(-quiet));
  const double right = layout.width_share(image.place_of(kModuleCount + quiet));
  const FrameHomography map(symbol.frame.corners, symbol.frame.lens);
  return {map(left, 0), map(right, 0), map(right, 1), map(left, 1)};
}

namespace {

BlackGrowth growth_of_bars(const Decoding& decoding, double module_px) {
  const double px = decoding.fit.image.growth * module_px;
  return {px, kSharpening.doubt * std::abs(px)};
}

// By the bars; where the picture was sharpened, by the frame's stroke.
BlackGrowth growth_by_bars_or_strokes(const SymbolHypothesis& symbol) {
  const BlackGrowth of_bars = growth_of_bars(symbol.decoding, symbol.profile.module_px);
  if (!symbol.frame.was_sharpened) return of_bars;
  std::vector<double> by_strokes = stroke_growths(symbol);
  std::erase_if(by_strokes,
                [&](double growth) { return std::abs(growth - of_bars.px) > kSide.tolerance; });
  const auto count = static_cast<double>(by_strokes.size());
  if (count == 0) return of_bars;
  double mean = 0, squares = 0;
  for (const double growth : by_strokes) mean += growth / count;
  for (const double growth : by_strokes) squares += (growth - mean) * (growth - mean);
  const double scatter = std::sqrt(squares / std::max(1.0, count - 1));
  return {mean, std::hypot(scatter, kSharpening.doubt * (mean - of_bars.px))};
}

}  // namespace

BlackGrowth growth_of(const SymbolHypothesis& symbol) {
  const Quad& corners = symbol.frame.corners;
  const FrameShape& shape = symbol.layout.frame;
  const double across = distance(corners[0], corners[1]) + distance(corners[2], corners[3]);
  const double along = distance(corners[1], corners[2]) + distance(corners[3], corners[0]);
  BlackGrowth growth = growth_by_bars_or_strokes(symbol);
  growth.along_bars_px = growth.px * (along / shape.height * shape.length / across - 1);
  return growth;
}

FrameCorners corners_of(const SymbolHypothesis& symbol) {
  const RefinedFrame& frame = symbol.frame;
  FrameCorners corners = widened(frame.corners, growth_of(symbol).px / 2);
  // The bars place a hidden side better than the estimate before them.
  const FrameCorners by_bars = corners_by_bars(symbol);
  if (!frame.shown[1]) {
    corners[1] = by_bars[1];
    corners[2] = by_bars[2];
  }
  if (!frame.shown[3]) {
    corners[3] = by_bars[3];
    corners[0] = by_bars[0];
  }
  return corners;
}

}  // namespace tagsmith::detail
