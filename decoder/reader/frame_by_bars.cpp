// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/frame_by_bars.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>

#include "decoder/feature_frame/bar_regions.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/coarse_fit.hpp"
#include "decoder/feature_frame/frame_around.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/reader/bar_ends.hpp"
#include "decoder/reader/tuning.hpp"
#include "decoder/scan/tuning.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith::detail {
namespace {

// Why: docs/decisions/0004-covered-tags.md.

// A field of bars and the lines where the frame's inner edges should be, in pixels of a level; the
// upper and lower ones where the bars show where they end.
struct FramedBars {
  BarRegion block{};
  std::array<std::optional<SideLine>, 4> sides{};  // from the upper one on, clockwise
  std::array<double, 4> sigma_px{};                // of each
  double module_px = 0;
  FrameShape shape;
};

// Where a module's line crosses a line parallel to `across`, `down` pixels along the bars from the
// centre.
PixelPoint crossing(const LocatedBars& bars, const BarRegion& block, double module, double down) {
  const PixelPoint normal = bars.normal_at(module);
  const double t =
      -(bars.distance_at(module) + down * dot(normal, block.along())) / dot(normal, block.across);
  return bars.centre + t * block.across + down * block.along();
}

std::optional<FramedBars> framed_bars(const LocatedBars& bars, const SymbolLayout& layout) {
  FramedBars framed{.shape = layout.frame};
  const PixelPoint normal = bars.normal_at(bars.a);
  const double steepness = length(normal);
  if (!(steepness > 1e-6) || !(bars.height > 4)) return std::nullopt;
  framed.module_px = 1 / steepness;
  BarRegion& block = framed.block;
  block.across = framed.module_px * normal;
  block.height = bars.height;
  const PixelPoint first = crossing(bars, block, 0, 0);
  const PixelPoint last = crossing(bars, block, kModuleCount, 0);
  block.centre = 0.5 * (first + last);
  block.length = distance(first, last);
  const double quiet = layout.quiet_zone_modules;
  const double half = block.height / 2;
  framed.sides[3] =
      line_through(crossing(bars, block, -quiet, half), crossing(bars, block, -quiet, -half));
  framed.sides[1] = line_through(crossing(bars, block, kModuleCount + quiet, -half),
                                 crossing(bars, block, kModuleCount + quiet, half));
  framed.sigma_px[1] = framed.sigma_px[3] = kImaging.edge * framed.module_px;
  return framed;
}

// Adds the upper and the lower side, where the bars of a field show both their ends. `first` and
// `last` are the field's bars in the layout.
void add_sides_by_ends(const BarField& field, const BarEnds& upper, const BarEnds& lower,
                       const SymbolLayout& layout, FramedBars& framed) {
  const FrameHomography map(field.corners, field.lens);
  const auto at = [&](double u, const BarEnds& ends) { return map(u, ends.at(u)); };
  const FrameHomography image_from_bars({at(field.first, upper), at(field.last, upper),
                                         at(field.last, lower), at(field.first, lower)},
                                        field.lens);
  const double height = layout.bar_height();
  const double above = -layout.bars_top / height, below = (1 - layout.bars_top) / height;
  framed.sides[0] = line_through(image_from_bars(0, above), image_from_bars(1, above));
  framed.sides[2] = line_through(image_from_bars(1, below), image_from_bars(0, below));
  // From the bars' ends, a quarter of their height farther out.
  framed.sigma_px[0] = std::hypot(1 - above, above) * std::max(upper.sigma_px, lower.sigma_px);
  framed.sigma_px[2] = framed.sigma_px[0];
}

// Adds the upper (0) or the lower (2) side where the bars show one of their ends; the others are
// those of `corners`.
void add_side_by_end(const Quad& corners, const BarField& field, std::size_t side,
                     const BarEnds& ends, const SymbolLayout& layout, FramedBars& framed) {
  const auto [completed, sigma] = frame_by_ends(corners, side, field, ends, layout);
  framed.sides[side] = line_through(completed[side], completed[side + 1]);
  framed.sigma_px[side] = sigma;
}

// The same for bars that were followed line by line, perhaps not over their full height: their ends
// are searched around them.
void look_for_ends(const GrayView& image, const LocatedBars& bars, const SymbolLayout& layout,
                   FramedBars& framed) {
  const double half = framed.block.height / 2;
  const BarField field{
      {crossing(bars, framed.block, 0, -half), crossing(bars, framed.block, kModuleCount, -half),
       crossing(bars, framed.block, kModuleCount, half), crossing(bars, framed.block, 0, half)}};
  const auto upper = find_bar_ends(image, field, kBarEnds.outside, -kBarEnds.followed_outside);
  if (!upper) return;
  const auto lower =
      find_bar_ends(image, field, 1 - kBarEnds.outside, 1 + kBarEnds.followed_outside);
  if (lower) add_sides_by_ends(field, *upper, *lower, layout, framed);
}

// In pixels of the image at half its size.
FramedBars halved(const FramedBars& bars) {
  const PixelPoint offset{0.5, 0.5};
  FramedBars result = bars;
  result.block = scaled(bars.block, 0.5);
  for (auto& side : result.sides) {
    if (side) side = line_through(0.5 * (side->begin - offset), 0.5 * (side->end - offset));
  }
  return result;
}

double distance_from(const SideLine& line, PixelPoint point) {
  return std::abs(dot(point - line.begin, line.outward));
}

// A quadrilateral with the sides that do not show put where the bars say, as far as they do.
std::optional<Quad> with_expected_sides(const Quad& quad, const FramedBars& expected,
                                        const std::array<bool, 4>& shown) {
  std::array<SideLine, 4> sides{};
  for (std::size_t i = 0; i < 4; ++i) {
    sides[i] =
        shown[i] || !expected.sides[i] ? side_of(quad, i, expected.shape) : *expected.sides[i];
  }
  return corners_of(sides);
}

// How far the frame's sides may be from where the bars say, pixels.
struct Tolerances {
  double beside = 0;   // left and right
  double at_ends = 0;  // above and below
};

// Takes sides that are not where the bars say as edges of something else, such as a cable.
void doubt_strangers(const Quad& quad, const FramedBars& expected, const Tolerances& tolerances,
                     std::array<bool, 4>& shown) {
  for (std::size_t i = 0; i < 4; ++i) {
    if (!expected.sides[i]) continue;
    const double tolerance = i % 2 == 1 ? tolerances.beside : tolerances.at_ends;
    shown[i] = shown[i] && distance_from(*expected.sides[i], quad[i]) < tolerance &&
               distance_from(*expected.sides[i], quad[(i + 1) % 4]) < tolerance;
  }
}

// The frame, fitted like one that is not covered, where all of its sides are visible: through an
// unknown lens its sides are curved.
RefinedFrame fitted_as_whole(const GrayView& image, const RefinedFrame& frame,
                             const LensGuess& lens, const FrameShape& shape) {
  if (!std::ranges::all_of(frame.shown, std::identity{})) return frame;
  return refine_frame(image, frame.corners, lens, shape).value_or(frame);
}

// Settles and fits the sides that are visible.
std::optional<RefinedFrame> fit_frame(const GrayView& image, const PyramidLevel& level,
                                      const Quad& rough, const FramedBars& in_full,
                                      const Tolerances& tolerances, const LensGuess& lens) {
  const LensDistortion known = lens.known.value_or(LensDistortion{});
  const SideSagittas bows = scaled(sagittas_of(known, to_full(level, rough)), 1 / level.scale);
  auto settled = settle_shown_sides(level.image, rough, bows, in_full.shape);
  if (!settled) return std::nullopt;
  const Quad in_image = to_full(level, settled->quad);
  const double coarse = 0.5 * level.scale;
  doubt_strangers(in_image, in_full, {tolerances.beside + coarse, tolerances.at_ends + coarse},
                  settled->shown);
  auto quad = with_expected_sides(in_image, in_full, settled->shown);
  if (!quad) return std::nullopt;
  const auto fit = [&](const std::array<bool, 4>& shown) {
    auto frame = refine_shown_sides(image, *quad, shown, 0, known, in_full.shape);
    for (std::size_t i = 0; frame && i < 4; ++i) {
      if (frame->shown[i]) continue;
      frame->sides[i].covariance +=
          in_full.sigma_px[i] * in_full.sigma_px[i] * Eigen::Matrix2d::Identity();
    }
    return frame;
  };
  auto frame = fit(settled->shown);
  if (!frame) return std::nullopt;
  std::array<bool, 4> shown = frame->shown;
  doubt_strangers(frame->corners, in_full, tolerances, shown);
  if (shown == frame->shown) return fitted_as_whole(image, *frame, lens, in_full.shape);
  quad = with_expected_sides(*quad, in_full, shown);
  if (!quad) return std::nullopt;
  frame = fit(shown);
  return frame ? std::optional(fitted_as_whole(image, *frame, lens, in_full.shape)) : std::nullopt;
}

}  // namespace

std::optional<RefinedFrame> frame_by_bars(const GrayView& image, const GrayView& half,
                                          const LocatedBars& bars, const SymbolLayout& layout,
                                          const LensGuess& lens) {
  auto in_full = framed_bars(bars, layout);
  if (!in_full) return std::nullopt;
  look_for_ends(image, bars, layout, *in_full);
  const PyramidLevel level{half, 2};
  const FramedBars in_level = halved(*in_full);
  const auto& sides = in_level.sides;
  const auto rough = sides[0] ? corners_of({*sides[0], *sides[1], *sides[2], *sides[3]})
                              : frame_between(level.image, in_level.block, *sides[3], *sides[1]);
  if (!rough) return std::nullopt;
  const double tolerance = kBarEnds.side * in_full->module_px;
  return fit_frame(image, level, *rough, *in_full, {tolerance, 1 + tolerance}, lens);
}

std::optional<RefinedFrame> frame_by_symbol(const GrayView& image, const GrayView& half,
                                            const Quad& expected, const SymbolLayout& layout,
                                            double module_px, const LensGuess& lens) {
  FramedBars in_full{.shape = layout.frame};
  in_full.sides[3] = line_through(expected[3], expected[0]);
  in_full.sides[1] = line_through(expected[1], expected[2]);
  in_full.sigma_px[1] = in_full.sigma_px[3] = kImaging.edge * module_px;
  const BarField field = bar_field(expected, layout, lens.known.value_or(LensDistortion{}));
  const BothEnds ends = find_both_ends(image, field);
  Quad rough = expected;
  if (ends.upper && ends.lower) {
    add_sides_by_ends(field, *ends.upper, *ends.lower, layout, in_full);
    const auto& sides = in_full.sides;
    rough = corners_of({*sides[0], *sides[1], *sides[2], *sides[3]}).value_or(expected);
  } else if (ends.upper) {
    add_side_by_end(expected, field, 0, *ends.upper, layout, in_full);
  } else if (ends.lower) {
    add_side_by_end(expected, field, 2, *ends.lower, layout, in_full);
  }
  const PyramidLevel level{half, 2};
  auto frame = fit_frame(image, level, to_level(level, rough), in_full,
                         {std::max(0.35, 0.12 * module_px), ends_tolerance_px(expected)}, lens);
  for (std::size_t i = 0; frame && i < 4; ++i) {
    if (!frame->shown[i] && !in_full.sides[i]) return std::nullopt;
  }
  return frame;
}

}  // namespace tagsmith::detail
