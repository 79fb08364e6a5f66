// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/symbol_hypothesis.hpp"

#include <algorithm>
#include <utility>

#include "decoder/feature_frame/bar_direction.hpp"
#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/reader/tuning.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// The best explained hypothesis along the symbol direction(s) that are possible. `profile_of` gives
// the profile of a layout from a first corner on.
template <class ProfileOf>
std::optional<SymbolHypothesis> best_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                const ReadOptions& options,
                                                const ProfileOf& profile_of) {
  const DecodeOptions decode_options{options.check, options.code_book};
  std::optional<SymbolHypothesis> best;
  const auto consider = [&](std::size_t first_corner, const SymbolLayout& layout) {
    SymbolProfile profile = profile_of(first_corner, layout);
    ImagingModel start;
    start.blur = std::clamp(profile.blur, 0.1, 3.0);
    const auto decoding = decode_profile(profile.bins, start, decode_options);
    if (!decoding) return;
    if (best && decoding->fit.explained <= best->decoding.fit.explained) return;
    best = SymbolHypothesis{frame, (first_corner + (decoding->upside_down ? 2 : 0)) % 4, layout,
                            std::move(profile), *decoding};
  };
  for (const std::size_t first_corner : possible_first_corners(image, frame.corners)) {
    for (const SymbolLayout& layout : options.layouts) consider(first_corner, layout);
  }
  return best;
}

}  // namespace

std::vector<std::size_t> possible_first_corners(const GrayView& image, const Quad& quad) {
  const BarSteps steps = bar_steps(image, quad);
  if (steps.along > kSearch.clear_direction * steps.across) return {0};
  if (steps.across > kSearch.clear_direction * steps.along) return {1};
  return {0, 1};
}

const RobustProfile& SymbolLook::seen(std::size_t first_corner, const SymbolLayout& layout) {
  const auto same = std::ranges::find_if(seen_, [&](const Seen& other) {
    return other.first_corner == first_corner && other.profile.layout() == layout;
  });
  if (same != seen_.end()) return same->profile;
  seen_.push_back({first_corner, RobustProfile(image_, frame_, first_corner, layout)});
  return seen_.back().profile;
}

std::optional<SymbolHypothesis> SymbolLook::by_agreeing_rows(const ReadOptions& options) {
  return best_hypothesis(image_, frame_, options,
                         [&](std::size_t first_corner, const SymbolLayout& layout) {
                           return seen(first_corner, layout).of_agreeing_rows();
                         });
}

std::optional<SymbolHypothesis> SymbolLook::by_all_rows(const ReadOptions& options,
                                                        AddedLight added) {
  return best_hypothesis(image_, frame_, options,
                         [&](std::size_t first_corner, const SymbolLayout& layout) {
                           return seen(first_corner, layout).of_all_rows(added);
                         });
}

std::optional<SymbolHypothesis> quick_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                 const ReadOptions& options) {
  return SymbolLook(image, frame).by_agreeing_rows(options);
}

std::optional<SymbolHypothesis> better_hypothesis(const GrayView& image, const RefinedFrame& frame,
                                                  const ReadOptions& options) {
  SymbolLook look(image, frame);
  auto quick = look.by_agreeing_rows(options);
  auto careful = look.by_all_rows(options, AddedLight::even);
  if (!careful || (quick && quick->decoding.fit.explained > careful->decoding.fit.explained)) {
    return quick;
  }
  return careful;
}

FrameCorners corners_by_bars(const SymbolHypothesis& symbol) {
  const ImagingModel& image = symbol.decoding.fit.image;
  const double quiet = symbol.layout.quiet_zone_modules;
  const auto u_of = [&](double module) {
    const double from_middle = module - kModuleCount / 2.0;
    const double t = 2 * from_middle / kModuleCount;
    const double seen = module + image.shift + image.stretch * from_middle + image.bend * t * t;
    return (quiet + seen) / (kModuleCount + 2 * quiet);
  };
  const double left = u_of(-quiet), right = u_of(kModuleCount + quiet);
  const FrameHomography map(turned_to(symbol.frame, symbol.first_corner).corners,
                            symbol.frame.lens);
  return {map(left, 0), map(right, 0), map(right, 1), map(left, 1)};
}

FrameCorners corners_of(const SymbolHypothesis& symbol) {
  const RefinedFrame& frame = symbol.frame;
  const double growth_px = symbol.decoding.fit.image.growth * symbol.profile.module_px;
  const Quad quad = widened(frame.corners, growth_px / 2);
  FrameCorners corners{};
  for (std::size_t i = 0; i < 4; ++i) corners[i] = quad[(symbol.first_corner + i) % 4];
  // The bars say better where a hidden side is than what said it before.
  const FrameCorners by_bars = corners_by_bars(symbol);
  if (!frame.shown[(symbol.first_corner + 1) % 4]) {
    corners[1] = by_bars[1];
    corners[2] = by_bars[2];
  }
  if (!frame.shown[(symbol.first_corner + 3) % 4]) {
    corners[3] = by_bars[3];
    corners[0] = by_bars[0];
  }
  return corners;
}

}  // namespace tagsmith::detail
