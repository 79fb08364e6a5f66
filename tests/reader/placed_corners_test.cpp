// SPDX-License-Identifier: Apache-2.0
// A frame's corners by its sides and its bars together.
#include "decoder/reader/placed_corners.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include "decoder/reader/symbol_hypothesis.hpp"
#include "tests/reader/drawn_symbol.hpp"
#include "tests/reader/shifted_rows.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::DrawnSymbol;
using tagsmith::detail::test::farthest_apart;
using tagsmith::detail::test::kDrawnDigits;
using tagsmith::detail::test::shift_rows;

namespace {

// The symbol in a frame whose sides beside the bars were fitted so many pixels too far out.
SymbolHypothesis symbol_in(const DrawnSymbol& drawn, double left_off, double right_off,
                           double sigma) {
  RefinedFrame frame = drawn.frame();
  frame.corners[0].x -= left_off;
  frame.corners[3].x -= left_off;
  frame.corners[1].x += right_off;
  frame.corners[2].x += right_off;
  for (FrameSide& side : frame.sides) side.covariance = sigma * sigma * Eigen::Matrix2d::Identity();
  ReadOptions options;
  options.layouts = {drawn.layout};
  auto symbol = quick_hypothesis(drawn.image.view(), frame, options);
  REQUIRE(symbol);
  REQUIRE(symbol->decoding.digits == kDrawnDigits);
  return *std::move(symbol);
}

PlacedCorners placed_in(const DrawnSymbol& drawn, const SymbolHypothesis& symbol) {
  const GrayView image = drawn.image.view();
  return placed_by_frame_and_bars(image, symbol, bar_ends_of(image, symbol));
}

}  // namespace

TEST_CASE("sides beside the bars are where the bars see them, and known as well") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  const SymbolHypothesis symbol = symbol_in(drawn, 0.2, -0.15, 0.1);
  const FrameCorners truth = drawn.frame().corners;
  CHECK(farthest_apart(corners_of(symbol), truth) > 0.14);
  const PlacedCorners placed = placed_in(drawn, symbol);
  CHECK(farthest_apart(placed.corners, truth) < 0.04);
  const CornerCovariance by_frame = corner_covariance(symbol.frame);
  for (Eigen::Index i = 0; i < 8; ++i) {
    CAPTURE(i);
    if (i % 2 == 0) CHECK(placed.covariance(i, i) < by_frame(i, i) / 9);  // along the bars
    if (i % 2 == 0) continue;
    CHECK(placed.covariance(i, i) < by_frame(i, i));  // their ends say less
    CHECK(placed.covariance(i, i) > by_frame(i, i) / 2);
  }
}

TEST_CASE("both halves of the bars' height turn a side") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.1);
  symbol.frame.corners[0].x -= 0.2;
  symbol.frame.corners[3].x += 0.2;
  const PlacedCorners placed = placed_in(drawn, symbol);
  CHECK(farthest_apart(placed.corners, drawn.frame().corners) < 0.06);
}

TEST_CASE("upper and lower sides that the bars' ends contradict are not sure of their place") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.03);
  symbol.frame.corners[0].y -= 3;
  const PlacedCorners placed = placed_in(drawn, symbol);
  const double off = placed.corners[0].y - drawn.frame().corners[0].y;
  CHECK(off * off < 9 * placed.covariance(1, 1));
  CHECK(corner_covariance(symbol.frame)(1, 1) < 0.01);
}

TEST_CASE(
    "a frame that contradicts its bars, as a bent plate's does, is unsure in all directions") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  for (const double off : {0.5, 2.0}) {
    CAPTURE(off);
    SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.03);
    symbol.frame.corners[2].x += off;
    const PlacedCorners placed = placed_in(drawn, symbol);
    const Eigen::SelfAdjointEigenSolver<CornerCovariance> axes(placed.covariance);
    const Eigen::VectorXd sigmas = axes.eigenvalues().cwiseSqrt();
    CHECK(sigmas.maxCoeff() > off);
    CHECK(sigmas.minCoeff() > 0.35 * sigmas.maxCoeff());
  }
}

TEST_CASE("a side beside which something else has its edge is as unsure as the bars' ends say") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  for (const std::size_t side : {0U, 2U}) {
    CAPTURE(side);
    SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.02);
    const double inwards = side == 0 ? 1 : -1;
    symbol.frame.corners[side].y += inwards;
    symbol.frame.corners[side + 1].y += inwards;
    const PlacedCorners placed = placed_in(drawn, symbol);
    for (const std::size_t corner : {side, side + 1}) {
      const auto y = static_cast<Eigen::Index>(2 * corner + 1);
      const double off = placed.corners[corner].y - drawn.frame().corners[corner].y;
      CHECK(std::abs(off) < 0.8);
      CHECK(off * off < 9 * placed.covariance(y, y));
      CHECK(placed.covariance(y, y) < 4);
    }
  }
}

TEST_CASE("bars that end as far off above as below say nothing against a frame's sides") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.02);
  const double margin = 0.4 / height_of(symbol.frame.corners);
  symbol.layout.bars_top += margin;
  symbol.layout.bars_bottom -= margin;
  CHECK(placed_in(drawn, symbol).covariance(1, 1) < 0.002);
  symbol.layout.bars_bottom += 2 * margin;
  CHECK(placed_in(drawn, symbol).covariance(1, 1) > 0.1);
}

TEST_CASE("a side is unsure where its own bars' ends are not in sight") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  const SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.02);
  BothEnds ends = bar_ends_of(drawn.image.view(), symbol);
  REQUIRE(ends.lower);
  const auto lower_variance = [&] {
    return placed_by_frame_and_bars(drawn.image.view(), symbol, ends).covariance(5, 5);
  };
  const double in_sight = lower_variance();
  ends.lower.reset();
  CHECK(lower_variance() > 4 * in_sight);
}

TEST_CASE("bars of another layout than the frame's do not move it, but it is less sure") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.05);
  symbol.layout.quiet_zone_modules = 9.5;
  const PlacedCorners placed = placed_in(drawn, symbol);
  CHECK(farthest_apart(placed.corners, corners_of(symbol)) == 0);
  // The bars have both sides half a module within, 1.5 px.
  CHECK(std::sqrt(placed.covariance(0, 0)) > 1.5);
  CHECK(std::sqrt(placed.covariance(0, 0)) < 5);
}

TEST_CASE("through a lens that only the frame's own sides tell, the bars say little") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  SymbolHypothesis symbol = symbol_in(drawn, 0.2, 0, 0.1);
  const double known = placed_in(drawn, symbol).covariance.trace();
  symbol.frame.lens_doubt = 1e-6;  // 0.4 px over a third of 339 px
  const PlacedCorners placed = placed_in(drawn, symbol);
  CHECK(placed.covariance.trace() > 1.5 * known);
  CHECK(farthest_apart(placed.corners, corners_of(symbol)) < 0.02);
  // Of a lens of which nothing is known they say nothing, not even how the lines turn on which they
  // end.
  symbol.frame.lens_doubt = 1e-3;
  const double by_frame = corner_covariance(symbol.frame).trace();
  CHECK(placed_in(drawn, symbol).covariance.trace() == doctest::Approx(by_frame).epsilon(0.001));
}

TEST_CASE("corners that a shaken camera's rows carry away are not sure of their place") {
  for (const double phase : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}) {
    CAPTURE(phase);
    DrawnSymbol drawn(kDrawnDigits, 3);
    const FrameCorners still = drawn.frame().corners;
    const double turn = 2 * std::numbers::pi / drawn.height();
    const auto shake = [&](double y) { return 0.8 * std::sin(turn * y + phase); };
    shift_rows(drawn.image, shake);
    // The straight lines that fit a period of the sine best.
    const double middle = (still[0].y + still[3].y) / 2;
    SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.3);
    const double lean = 0.8 * 3 / std::numbers::pi * std::cos(turn * middle + phase);
    for (PixelPoint& corner : symbol.frame.corners) {
      corner.x += lean * (corner.y - middle) / (drawn.height() / 2.0);
    }
    const PlacedCorners placed = placed_in(drawn, symbol);
    for (std::size_t i = 0; i < 4; ++i) {
      CAPTURE(i);
      const double off = placed.corners[i].x - still[i].x - shake(still[i].y);
      const auto row = static_cast<Eigen::Index>(2 * i);
      CHECK(std::abs(off) < 3 * std::sqrt(placed.covariance(row, row)));
    }
  }
}

TEST_CASE("what shaken rows leave of a side's fit does not hide that the bars are bent") {
  const auto traces = [](double shaken) {
    DrawnSymbol drawn(kDrawnDigits, 3);
    const double turn = std::numbers::pi / drawn.height();
    shift_rows(drawn.image, [&](double y) { return shaken * std::sin(turn * (y - 30)); });
    SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.05);
    for (const std::size_t side : {1U, 3U}) symbol.frame.sides[side].pixel_locking_px = 0.1;
    return placed_in(drawn, symbol).covariance.trace();
  };
  CHECK(traces(0.3) > traces(0) + 4 * 0.1 * 0.1);
}

TEST_CASE("corners in two fields of a picture are as unsure as these are apart") {
  const auto sigma = [](double apart) {
    DrawnSymbol drawn(kDrawnDigits, 3);
    for (const double blurred : {0.5, -0.5}) shift_rows(drawn.image, [&](int) { return blurred; });
    shift_rows(drawn.image, [&](int y) { return y % 2 == 0 ? apart / 2 : -apart / 2; });
    return placed_in(drawn, symbol_in(drawn, 0, 0, 0.02)).covariance.diagonal().cwiseSqrt().eval();
  };
  CHECK(sigma(0).maxCoeff() < 0.1);
  for (const double apart : {0.8, -2.0}) {
    CAPTURE(apart);
    CHECK(sigma(apart).minCoeff() > 0.4 * std::abs(apart));
  }
}

TEST_CASE("corners in a picture of two moments may be where either of them has them") {
  const auto sigma = [](PixelPoint apart) {
    DrawnSymbol drawn(kDrawnDigits, 3);
    for (const double blurred : {0.5, -0.5}) shift_rows(drawn.image, [&](int) { return blurred; });
    const GrayImage once = drawn.image;
    for (int y = 0; y < once.height; ++y) {
      for (int x = 0; x < once.width; ++x) {
        const PixelPoint from{std::clamp(x - apart.x, 0.0, once.width - 1.0),
                              std::clamp(y - apart.y, 0.0, once.height - 1.0)};
        std::uint8_t& sample = drawn.image.samples[static_cast<std::size_t>(y * once.width + x)];
        sample = static_cast<std::uint8_t>(
            std::lround(0.7 * sample + 0.3 * sample_bilinear(once.view(), from)));
      }
    }
    SymbolHypothesis symbol = symbol_in(drawn, 0, 0, 0.02);
    for (FrameSide& side : symbol.frame.sides) side.blur_px = 1;
    return placed_in(drawn, symbol).covariance.diagonal().cwiseSqrt().eval();
  };
  CHECK(sigma({0, 0}).maxCoeff() < 0.1);
  for (const PixelPoint apart : {PixelPoint{2, 0}, {-3, 0}, {0, 2}, {0, -3}, {1.5, 1.5}}) {
    CAPTURE(apart.x);
    CAPTURE(apart.y);
    CHECK(sigma(apart).minCoeff() > 0.25 * std::hypot(apart.x, apart.y));
  }
}

TEST_CASE("rows that only lean leave corners as sure as they were") {
  const DrawnSymbol drawn(kDrawnDigits, 3);
  const double still = placed_in(drawn, symbol_in(drawn, 0, 0, 0.1)).covariance.trace();
  DrawnSymbol leaning = drawn;
  for (const double blurred : {0.5, -0.5}) shift_rows(leaning.image, [&](int) { return blurred; });
  const auto lean = [](double y) { return 0.01 * (y - 90); };
  shift_rows(leaning.image, lean);
  SymbolHypothesis symbol = symbol_in(leaning, 0, 0, 0.1);
  for (PixelPoint& corner : symbol.frame.corners) corner.x += lean(corner.y);
  CHECK(placed_in(leaning, symbol).covariance.trace() < 1.5 * still);
}
