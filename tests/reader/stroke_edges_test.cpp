// SPDX-License-Identifier: Apache-2.0
// How thick a frame's strokes are seen to be, side by side.
#include "decoder/reader/stroke_edges.hpp"

#include <cmath>
#include <cstddef>

#include <doctest/doctest.h>

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
