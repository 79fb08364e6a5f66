// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/frame_by_bars.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "decoder/feature_frame/bar_blocks.hpp"
#include "decoder/feature_frame/candidates.hpp"
#include "decoder/feature_frame/frame_around.hpp"
#include "decoder/feature_frame/settle_frame.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "decoder/image/bilinear.hpp"
#include "decoder/reader/frameless.hpp"
#include "tagsmith/symbology/upca.hpp"

namespace tagsmith {
namespace {

// A field of bars and the lines where the frame's left and right inner edges should be, in pixels
// of a level.
struct FramedBars {
  BarBlock block;
  SideLine left;   // upwards
  SideLine right;  // downwards
  double module_px = 0;
};

SideLine line_through(PixelPoint begin, PixelPoint end) {
  SideLine line;
  line.begin = begin;
  line.end = end;
  return moved(line, 0, 0);
}

// Where a module's line crosses a line parallel to `across`, `down` pixels along the bars from the
// centre.
PixelPoint crossing(const LocatedBars& bars, const BarBlock& block, double module, double down) {
  const PixelPoint normal = bars.normal_at(module);
  const double t =
      -(bars.distance_at(module) + down * dot(normal, block.along)) / dot(normal, block.across);
  return bars.centre + t * block.across + down * block.along;
}

std::optional<FramedBars> framed_bars(const LocatedBars& bars, const SymbolLayout& layout) {
  FramedBars framed;
  const PixelPoint normal = bars.normal_at(bars.a);
  const double steepness = length(normal);
  if (!(steepness > 1e-6) || !(bars.height > 4)) return std::nullopt;
  framed.module_px = 1 / steepness;
  BarBlock& block = framed.block;
  block.across = framed.module_px * normal;
  block.along = {-block.across.y, block.across.x};
  block.half_height = bars.height / 2;
  const PixelPoint first = crossing(bars, block, 0, 0);
  const PixelPoint last = crossing(bars, block, kModuleCount, 0);
  block.centre = 0.5 * (first + last);
  block.half_width = distance(first, last) / 2;
  const double quiet = layout.quiet_zone_modules;
  const double half = block.half_height;
  framed.left =
      line_through(crossing(bars, block, -quiet, half), crossing(bars, block, -quiet, -half));
  framed.right = line_through(crossing(bars, block, kModuleCount + quiet, -half),
                              crossing(bars, block, kModuleCount + quiet, half));
  return framed;
}

// In pixels of the image at half its size.
FramedBars halved(const FramedBars& bars) {
  const auto half = [](const SideLine& side) {
    const PixelPoint offset{0.5, 0.5};
    return line_through(0.5 * (side.begin - offset), 0.5 * (side.end - offset));
  };
  return {scaled(bars.block, 0.5), half(bars.left), half(bars.right), bars.module_px / 2};
}

double distance_from(const SideLine& line, PixelPoint point) {
  return std::abs(dot(point - line.begin, line.outward));
}

// A quadrilateral with its left or right side, or both, put where the bars say.
std::optional<Quad> with_expected_sides(const Quad& quad, const FramedBars& expected,
                                        const std::array<bool, 4>& shown) {
  std::array<SideLine, 4> sides{};
  for (std::size_t i = 0; i < 4; ++i) sides[i] = side_of(quad, i);
  if (!shown[1]) sides[1] = expected.right;
  if (!shown[3]) sides[3] = expected.left;
  return corners_of(sides);
}

// Takes sides that are not where the bars say for something else: a cable has an edge too.
void doubt_strangers(const Quad& quad, const FramedBars& expected, double tolerance,
                     std::array<bool, 4>& shown) {
  const auto agrees = [&](const SideLine& line, PixelPoint a, PixelPoint b) {
    return distance_from(line, a) < tolerance && distance_from(line, b) < tolerance;
  };
  shown[1] = shown[1] && agrees(expected.right, quad[1], quad[2]);
  shown[3] = shown[3] && agrees(expected.left, quad[3], quad[0]);
}

// Settles and fits the sides that show; `tolerance` is how far the left and right ones may be from
// where the bars say, pixels of the full image.
std::optional<RefinedFrame> fit_frame(const GrayView& image, const PyramidLevel& level,
                                      const Quad& rough, const FramedBars& in_full,
                                      double tolerance) {
  constexpr double kHiddenSigma = 0.2;  // modules
  auto settled = settle_shown_sides(level.image, rough);
  if (!settled) return std::nullopt;
  const Quad in_image = to_full(level, settled->quad);
  doubt_strangers(in_image, in_full, tolerance + 0.5 * level.scale, settled->shown);
  auto quad = with_expected_sides(in_image, in_full, settled->shown);
  if (!quad) return std::nullopt;
  const double sigma = kHiddenSigma * in_full.module_px;
  auto frame = refine_shown_sides(image, *quad, settled->shown, sigma);
  if (!frame) return std::nullopt;
  std::array<bool, 4> shown = frame->shown;
  doubt_strangers(frame->corners, in_full, tolerance, shown);
  if (shown == frame->shown) return *frame;
  quad = with_expected_sides(*quad, in_full, shown);
  if (!quad) return std::nullopt;
  frame = refine_shown_sides(image, *quad, shown, sigma);
  return frame ? std::optional(*frame) : std::nullopt;
}

constexpr double kReducedFrom = 1.8;  // pixels a module: noise halves, bars stay apart

}  // namespace

std::optional<RefinedFrame> frame_by_bars(const GrayView& image, const GrayView& half,
                                          const BarRegion& region, const SymbolLayout& layout) {
  constexpr double kTolerance = 1.2;  // modules
  const auto bars = locate_bars(image, region);
  if (!bars) return std::nullopt;
  const auto in_full = framed_bars(*bars, layout);
  if (!in_full) return std::nullopt;
  const bool reduce = in_full->module_px >= kReducedFrom;
  const PyramidLevel level{reduce ? half : image, reduce ? 2.0 : 1.0};
  const FramedBars in_level = reduce ? halved(*in_full) : *in_full;
  const auto rough = frame_between(level.image, in_level.block, in_level.left, in_level.right);
  if (!rough) return std::nullopt;
  return fit_frame(image, level, *rough, *in_full, kTolerance * in_full->module_px);
}

std::optional<RefinedFrame> frame_by_symbol(const GrayView& image, const GrayView& half,
                                            const Quad& expected, double module_px) {
  const double tolerance = std::max(0.35, 0.12 * module_px);
  FramedBars in_full;
  in_full.left = line_through(expected[3], expected[0]);
  in_full.right = line_through(expected[1], expected[2]);
  in_full.module_px = module_px;
  const bool reduce = module_px >= kReducedFrom;
  const PyramidLevel level{reduce ? half : image, reduce ? 2.0 : 1.0};
  return fit_frame(image, level, to_level(level, expected), in_full, tolerance);
}

namespace {

// Places along one half of the symbol, as grey levels less their mean.
using HalfRow = std::array<double, 96>;

HalfRow half_row(const GrayView& image, const Homography& map, double first_u, double v) {
  constexpr double kWidth = 0.38;  // of the frame: half of the bars, clear of their quiet zone
  HalfRow row{};
  double mean = 0;
  for (std::size_t k = 0; k < row.size(); ++k) {
    const double u = first_u + kWidth * static_cast<double>(k) / (row.size() - 1.0);
    row[k] = sample_bilinear(image, map(u, v));
    mean += row[k] / static_cast<double>(row.size());
  }
  for (double& value : row) value -= mean;
  return row;
}

double product(const HalfRow& a, const HalfRow& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// The mean of rows in the middle of the bars.
HalfRow usual_row(const GrayView& image, const Homography& map, double first_u) {
  constexpr int kRows = 16;
  HalfRow mean{};
  for (int i = 0; i < kRows; ++i) {
    const HalfRow row = half_row(image, map, first_u, 0.3 + 0.4 * i / (kRows - 1));
    for (std::size_t k = 0; k < row.size(); ++k) mean[k] += row[k] / kRows;
  }
  return mean;
}

// Where, going outwards from the bars, rows stop being like the usual one; nothing where that is
// not near `expected`. `step` is half a pixel outwards.
std::optional<double> end_of_bars(const GrayView& image, const Homography& map, double first_u,
                                  double expected, double step) {
  constexpr int kReach = 10;  // steps
  const HalfRow usual = usual_row(image, map, first_u);
  const double full = product(usual, usual);
  if (!(full > 0)) return std::nullopt;
  double before = 0;
  for (int k = -kReach; k <= kReach; ++k) {
    const double v = expected + k * step;
    const double share = product(half_row(image, map, first_u, v), usual) / full;
    if (k > -kReach && before >= 0.5 && share < 0.5) {
      return v - step * (0.5 - share) / (before - share);
    }
    before = share;
  }
  return std::nullopt;
}

}  // namespace

bool bars_end_as_expected(const GrayView& image, const Quad& corners, const SymbolLayout& layout) {
  constexpr double kTolerance = 1;     // pixels
  constexpr double kOfHeight = 0.005;  // templates round their margins
  constexpr int kLeastRight = 3;
  const Homography map = homography_to(corners);
  const double height = (distance(corners[0], corners[3]) + distance(corners[1], corners[2])) / 2;
  const double step = 0.5 / height;
  const double tolerance = kTolerance / height + kOfHeight;
  int right = 0;
  for (const double first_u : {0.1, 0.52}) {
    const auto top = end_of_bars(image, map, first_u, layout.bars_top, -step);
    const auto bottom = end_of_bars(image, map, first_u, layout.bars_bottom, step);
    right += top && std::abs(*top - layout.bars_top) < tolerance ? 1 : 0;
    right += bottom && std::abs(*bottom - layout.bars_bottom) < tolerance ? 1 : 0;
  }
  return right >= kLeastRight;
}

}  // namespace tagsmith
