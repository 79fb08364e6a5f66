// SPDX-License-Identifier: Apache-2.0
// How thick a frame's strokes are seen to be, side by side.
#include "decoder/reader/stroke_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/image/tone_curve.hpp"
#include "decoder/reader/placed_corners.hpp"
#include "tests/reader/drawn_symbol.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::DrawnSymbol;
using tagsmith::detail::test::kDrawnDigits;

namespace {

constexpr int kStroke = DrawnSymbol::kStroke;

// The symbol in its frame, whose lower side was fitted so many pixels too far down.
SymbolHypothesis symbol_of(const DrawnSymbol& drawn, double lower = 0) {
  RefinedFrame frame = drawn.frame();
  frame.corners[2].y += lower;
  frame.corners[3].y += lower;
  ReadOptions options;
  options.layouts = {drawn.layout};
  auto symbol = quick_hypothesis(drawn.image.view(), frame, options);
  REQUIRE(symbol);
  return *std::move(symbol);
}

// White over the lower stroke's inner edge, that many pixels.
DrawnSymbol with_crust(int thickness) {
  DrawnSymbol drawn(kDrawnDigits, 3);
  drawn.fill(0, drawn.height(), drawn.width(), drawn.height() + thickness, DrawnSymbol::kWhite);
  return drawn;
}

// Blurs along the rows, then along the columns, by a Gaussian in light.
void blur(double sigma, GrayImage& image) {
  const ToneCurve& tone = ToneCurve::srgb();
  std::array<double, 13> weights{};
  double sum = 0;
  for (int i = -6; i <= 6; ++i) {
    sum += weights[static_cast<std::size_t>(i + 6)] = std::exp(-i * i / (2 * sigma * sigma));
  }
  std::vector<double> light(image.samples.size()), blurred(light.size());
  std::ranges::transform(image.samples, light.begin(),
                         [&](std::uint8_t sample) { return tone.light_of(sample); });
  const int sizes[] = {image.width, image.height}, steps[] = {1, image.width};
  for (const int axis : {0, 1}) {
    for (int i = 0; i < std::ssize(light); ++i) {
      const int at = i / steps[axis] % sizes[axis];
      double mean = 0;
      for (int k = -6; k <= 6; ++k) {
        const int near = std::clamp(at + k, 0, sizes[axis] - 1) - at;
        mean += weights[static_cast<std::size_t>(k + 6)] / sum *
                light[static_cast<std::size_t>(i + near * steps[axis])];
      }
      blurred[static_cast<std::size_t>(i)] = mean;
    }
    light.swap(blurred);
  }
  std::ranges::transform(light, image.samples.begin(), [&](double at) {
    return static_cast<std::uint8_t>(std::lround(tone.sample_of(at)));
  });
}

}  // namespace

TEST_CASE("strokes as the layout has them have no excess") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  for (const auto& excess : stroke_excesses(drawn.image.view(), symbol_of(drawn))) {
    REQUIRE(excess);
    CHECK(std::abs(excess->px) < excess->sigma_px);
    CHECK(excess->sigma_px < 0.3);
  }
}

TEST_CASE("a crust along one stroke's inner edge leaves this one thinner") {
  const DrawnSymbol drawn = with_crust(3);
  const auto excesses = stroke_excesses(drawn.image.view(), symbol_of(drawn, 3));
  for (std::size_t side = 0; side < 4; ++side) {
    CAPTURE(side);
    REQUIRE(excesses[side]);
    CHECK(std::abs(excesses[side]->px - (side == 2 ? -3 : 0)) < 0.4);
  }
}

TEST_CASE("strokes of another thickness all around are another template's, and no crust") {
  DrawnSymbol drawn(kDrawnDigits, 3);
  drawn.layout.frame.stroke *= 0.7;
  for (const auto& excess : stroke_excesses(drawn.image.view(), symbol_of(drawn))) {
    REQUIRE(excess);
    CHECK(std::abs(excess->px) < 2 * excess->sigma_px);
  }
}

TEST_CASE(
    "with a known template, crusts along most strokes leave these thinner, not the others "
    "thicker") {
  DrawnSymbol drawn(kDrawnDigits, 3);
  drawn.layout.frame.stroke = kStroke / 3.0;
  drawn.layout.frame.stroke_tolerance = 0.03;
  drawn.fill(0, -2, drawn.width(), 0, DrawnSymbol::kWhite);
  drawn.fill(0, drawn.height(), drawn.width(), drawn.height() + 2, DrawnSymbol::kWhite);
  drawn.fill(-2, 0, 0, drawn.height(), DrawnSymbol::kWhite);
  RefinedFrame frame = drawn.frame();
  for (std::size_t corner = 0; corner < 4; ++corner) {
    frame.corners[corner].y += corner < 2 ? -2 : 2;
    if (corner == 0 || corner == 3) frame.corners[corner].x -= 2;
  }
  ReadOptions options;
  options.layouts = {drawn.layout};
  options.code_book = {kDrawnDigits};
  const auto symbol = quick_hypothesis(drawn.image.view(), frame, options);
  REQUIRE(symbol);
  const auto excesses = stroke_excesses(drawn.image.view(), *symbol);
  for (std::size_t side = 0; side < 4; ++side) {
    CAPTURE(side);
    REQUIRE(excesses[side]);
    if (side == 1) {
      CHECK(std::abs(excesses[side]->px) < 2 * excesses[side]->sigma_px);
    } else {
      CHECK(excesses[side]->px < -1);
      CHECK(excesses[side]->px < -2 * excesses[side]->sigma_px);
    }
  }
}

TEST_CASE("beside a narrow white margin, a blurred stroke is not thinner for it") {
  for (const int margin : {3, 4, 6}) {
    CAPTURE(margin);
    DrawnSymbol drawn(kDrawnDigits, 3);
    drawn.layout.frame.stroke = kStroke / 3.0;
    drawn.layout.frame.stroke_tolerance = 0.03;
    const int beyond = kStroke + margin, far = DrawnSymbol::kMargin;
    const int right = drawn.width() + beyond, below = drawn.height() + beyond;
    drawn.fill(-far, -far, drawn.width() + far, -beyond, 10);
    drawn.fill(-far, below, drawn.width() + far, drawn.height() + far, 10);
    drawn.fill(-far, -beyond, -beyond, below, 10);
    drawn.fill(right, -beyond, drawn.width() + far, below, 10);
    blur(1.6, drawn.image);
    for (const auto& excess : stroke_excesses(drawn.image.view(), symbol_of(drawn))) {
      if (excess) CHECK(std::abs(excess->px) < 2 * excess->sigma_px);
    }
  }
}

TEST_CASE("where it is as dark beside a stroke, nothing is known of its outer edge") {
  DrawnSymbol drawn(kDrawnDigits, 3);
  const int below = drawn.height() + kStroke;
  drawn.fill(-kStroke, below, drawn.width() + kStroke, drawn.height() + DrawnSymbol::kMargin,
             DrawnSymbol::kBlack);
  const auto excesses = stroke_excesses(drawn.image.view(), symbol_of(drawn));
  CHECK(excesses[0]);
  CHECK_FALSE(excesses[2]);
}

TEST_CASE("corners beside a crust are where the bars' ends have them, and unsure by as much") {
  const DrawnSymbol drawn = with_crust(3);
  const SymbolHypothesis symbol = symbol_of(drawn, 3);
  const GrayView image = drawn.image.view();
  const PlacedCorners placed = placed_by_frame_and_bars(image, symbol, bar_ends_of(image, symbol));
  for (const std::size_t corner : {std::size_t{2}, std::size_t{3}}) {
    const double off = placed.corners[corner].y - drawn.frame().corners[corner].y;
    const auto row = static_cast<Eigen::Index>(2 * corner + 1);
    CHECK(std::abs(off) < 1);
    CHECK(std::abs(off) < 3 * std::sqrt(placed.covariance(row, row)));
    CHECK(placed.covariance(row, row) < 1);
  }
  const double upper = placed.corners[0].y - drawn.frame().corners[0].y;
  CHECK(std::abs(upper) < 0.1);
  CHECK(placed.covariance(1, 1) < 0.05);
}

TEST_CASE("what all strokes lack of a known template makes all sides unsure alike") {
  DrawnSymbol drawn(kDrawnDigits, 3);
  drawn.layout.frame.stroke = 1.02 * kStroke / 3.0;
  drawn.layout.frame.stroke_tolerance = 0.03;
  const SymbolHypothesis symbol = symbol_of(drawn);
  for (const auto& excess : stroke_excesses(drawn.image.view(), symbol)) {
    REQUIRE(excess);
    CHECK(excess->common_px == doctest::Approx(-0.02 * kStroke).epsilon(0.3));
    CHECK(std::abs(excess->px) < excess->sigma_px);
  }
  const double added = (covariance_by_frame(drawn.image.view(), symbol) -
                        corner_covariance(symbol.frame, growth_of(symbol).doubt_px / 2))
                           .trace();
  const double half = 0.01 * kStroke;
  CHECK(added == doctest::Approx(8 * half * half).epsilon(0.6));
}

TEST_CASE("what two strokes lack of a stretched print is nothing that all have in common") {
  DrawnSymbol drawn(kDrawnDigits, 3);
  drawn.layout.frame.stroke = kStroke / 3.0;
  drawn.layout.frame.stroke_tolerance = 0.03;
  const int w = drawn.width(), h = drawn.height();
  drawn.fill(-kStroke, -kStroke, 1 - kStroke, h + kStroke, DrawnSymbol::kWhite);
  drawn.fill(w + kStroke - 1, -kStroke, w + kStroke, h + kStroke, DrawnSymbol::kWhite);
  for (const auto& excess : stroke_excesses(drawn.image.view(), symbol_of(drawn))) {
    REQUIRE(excess);
    CHECK(std::abs(excess->common_px) < 0.1);
  }
}
