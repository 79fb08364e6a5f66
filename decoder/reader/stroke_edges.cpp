// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/stroke_edges.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

#include "decoder/feature_frame/lens_distortion.hpp"
#include "decoder/feature_frame/tuning.hpp"
#include "decoder/image/line_levels.hpp"
#include "decoder/image/tone_curve.hpp"
#include "tagsmith/base/statistics.hpp"

namespace tagsmith::detail {
namespace {

// From the inner edge of a stroke outwards, at a share of the side's length.
struct AcrossStroke {
  PixelPoint inner, outer;  // as the layout has them
};

AcrossStroke across_stroke(const FrameHomography& map, const FrameShape& shape, std::size_t side,
                           double share) {
  constexpr Quad unit{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  const PixelPoint begin = unit[side], end = unit[(side + 1) % 4];
  const PixelPoint inner = begin + share * (end - begin);
  const double thick = shape.stroke / (side % 2 == 0 ? shape.height : shape.length);
  const PixelPoint along = end - begin;
  const PixelPoint outer = inner + thick * PixelPoint{along.y, -along.x};
  return {map(inner.x, inner.y), map(outer.x, outer.y)};
}

// Light along a line, at steps of a pixel from a place on.
struct LightAlong {
  int first = 0;  // pixels from the line's begin
  std::vector<double> light;

  // Where it first exceeds the level, which it does not at its begin; pixels from the line's begin.
  std::optional<double> crossing(double level) const {
    const auto end = std::ranges::find_if(light, [&](double at) { return at > level; });
    if (end == light.begin() || end == light.end()) return std::nullopt;
    const double before = *std::prev(end);
    return first + static_cast<double>(end - light.begin()) - (*end - level) / (*end - before);
  }
};

std::optional<LightAlong> light_along(const GrayView& image, const PixelPoint& begin,
                                      const PixelPoint& along, int first, int last) {
  const PlacesOnLine places{begin, along, first, 1};
  if (!is_inside(image, places.at(0)) || !is_inside(image, places.at(last - first))) {
    return std::nullopt;
  }
  LightAlong seen{first, std::vector<double>(static_cast<std::size_t>(last - first + 1))};
  sample_line(image, places, seen.light);
  const ToneCurve& tone = ToneCurve::of(image);
  std::ranges::transform(seen.light, seen.light.begin(),
                         [&](double level) { return tone.light_near(level); });
  return seen;
}

// How far beyond its place in the layout a stroke ends. It ends half way between black and white;
// white beside it is that inside the frame, or less in a shadow that ends along the stroke, or
// where a narrow white margin is blurred. The end lies between what the two say.
std::optional<StrokeExcess> excess_at(const GrayView& image, const AcrossStroke& line, double share,
                                      const FrameSide& side) {
  const double thickness = distance(line.inner, line.outer);
  if (thickness < kEdgeFit.thin_stroke) return std::nullopt;
  const PixelPoint outward = (1 / thickness) * (line.outer - line.inner);
  const auto seen = light_along(image, line.inner, outward, static_cast<int>(thickness / 2),
                                static_cast<int>(std::ceil(1.4 * thickness)) + 2);
  if (!seen) return std::nullopt;
  const double beside = std::ranges::max(seen->light);
  const double white = side.white_begin + share * (side.white_end - side.white_begin);
  // Blur lightens the middle of a thin stroke.
  const double black =
      std::min(seen->light.front(), side.black_begin + share * (side.black_end - side.black_begin));
  const double contrast =
      std::min(side.white_begin - side.black_begin, side.white_end - side.black_end);
  if (!(beside - black > 0.08 * std::max(contrast, 0.1))) return std::nullopt;
  const auto near = seen->crossing((beside + black) / 2);
  if (!near) return std::nullopt;
  const double far =
      seen->crossing((std::max(white, beside) + black) / 2).value_or(*near + side.blur_px);
  return StrokeExcess{(*near + far) / 2 - thickness, (far - *near) / 2};
}

// A stroke's excess, growth included; `thickness` is set to that of the layout. `map`: from the
// unit square to the frame's inner edge.
std::optional<StrokeExcess> excess_of_side(const GrayView& image, const SymbolHypothesis& symbol,
                                           const FrameHomography& map, std::size_t side,
                                           double& thickness) {
  std::vector<double> seen, unsure;
  for (std::size_t i = 0; i < 9; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / 9;
    const AcrossStroke line = across_stroke(map, symbol.layout.frame, side, share);
    if (i == 4) thickness = distance(line.inner, line.outer);
    const auto excess = excess_at(image, line, share, symbol.frame.sides[side]);
    if (!excess) continue;
    seen.push_back(excess->px);
    unsure.push_back(excess->sigma_px);
  }
  if (seen.size() < 6) return std::nullopt;
  const double middle = quantile(seen, 0.5);
  for (double& excess : seen) excess = std::abs(excess - middle);
  const double scatter = quantile(seen, 0.5) / std::sqrt(static_cast<double>(seen.size()));
  const double unknown = std::hypot(0.1, 0.01 * thickness, 2 * symbol.frame.unexplained_bow);
  return StrokeExcess{middle, std::hypot(2 * scatter, unknown, quantile(unsure, 0.5))};
}

}  // namespace

StrokeExcesses stroke_excesses(const GrayView& image, const SymbolHypothesis& symbol) {
  const FrameHomography map(symbol.frame.corners, symbol.frame.lens);
  const BlackGrowth growth = growth_of(symbol);
  StrokeExcesses excesses;
  std::array<double, 4> thickness{};
  std::vector<double> shares;
  for (std::size_t side = 0; side < 4; ++side) {
    if (!symbol.frame.shown[side]) continue;
    excesses[side] = excess_of_side(image, symbol, map, side, thickness[side]);
    if (!excesses[side]) continue;
    excesses[side]->px -= growth.px;
    const double unknown = side % 2 == 0 ? growth.along_bars_px : 0;
    excesses[side]->sigma_px = std::hypot(excesses[side]->sigma_px, unknown);
    shares.push_back(excesses[side]->px / thickness[side]);
  }
  if (shares.empty()) return excesses;
  // What most strokes have in common is the print's. Where it is more than that, most have a crust.
  const double of_print = symbol.layout.frame.stroke_tolerance;
  const bool is_known = of_print < 1;
  std::ranges::sort(shares);
  const double low = shares[(shares.size() - 1) / 2], high = shares[shares.size() / 2];
  const double common = std::clamp((low + high) / 2, -of_print, of_print);
  // What two lack and two do not is of a stretched print, not of all edges.
  const double of_most = std::clamp(low > 0 ? low : std::min(high, 0.0), -of_print, of_print);
  for (std::size_t side = 0; side < 4; ++side) {
    if (!excesses[side]) continue;
    const double alone = excesses[side]->px - common * thickness[side];
    if (is_known) excesses[side]->common_px = of_most * thickness[side];
    if (std::abs(alone) < std::abs(excesses[side]->px)) excesses[side]->px = alone;
  }
  return excesses;
}

}  // namespace tagsmith::detail
