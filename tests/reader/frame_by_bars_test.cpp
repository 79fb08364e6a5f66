// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/frame_by_bars.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "decoder/image/transform.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::farthest_apart;
using tagsmith::detail::test::PlaneCover;
using tagsmith::detail::test::PlaneView;
using tagsmith::detail::test::SeenTag;

namespace {

SeenTag bars_seen_aslant() {
  SeenTag tag;
  tag.width = 360;
  tag.height = 220;
  tag.view = {{180, 110}, 2.4, 0.15, {0.001, -0.002}};
  return tag;
}

// The bars of a tag, where the plane has them, followed over most of their height.
LocatedBars bars_of(const SeenTag& tag) {
  const PlaneView& view = tag.view;
  const double c = std::cos(view.turn), s = std::sin(view.turn);
  const auto in_image = [&](PixelPoint d) {
    return 1 / view.module_px * PixelPoint{c * d.x - s * d.y, s * d.x + c * d.y};
  };
  // x + 47.5 with x = q.x / (1 + slant . q).
  LocatedBars bars;
  bars.a = 47.5;
  bars.c = in_image(view.slant);
  bars.b = in_image({1, 0}) + 47.5 * bars.c;
  bars.centre = view.middle;
  bars.height = 0.8 * tag.region().height;
  return bars;
}

std::optional<RefinedFrame> completed(const SeenTag& tag) {
  const GrayImage image = tag.image(), half = half_size(image.view());
  return frame_by_bars(image.view(), half.view(), bars_of(tag), SymbolLayout{});
}

std::optional<RefinedFrame> fitted(const SeenTag& tag, const Quad& expected) {
  const GrayImage image = tag.image(), half = half_size(image.view());
  return frame_by_symbol(image.view(), half.view(), expected, SymbolLayout{}, tag.view.module_px);
}

}  // namespace

TEST_CASE("bars as they are made here are where the plane has them") {
  const SeenTag tag = bars_seen_aslant();
  const LocatedBars bars = bars_of(tag);
  for (const PixelPoint at : {PixelPoint{-47.5, -10}, {12, 9}, {47.5, 3}}) {
    CHECK(bars.module_of(tag.view.pixel(at)) == doctest::Approx(at.x + 47.5));
  }
}

TEST_CASE("a frame that shows all around is fitted around its bars") {
  const SeenTag tag = bars_seen_aslant();
  const auto frame = completed(tag);
  REQUIRE(frame);
  CHECK(frame->shown == std::array<bool, 4>{true, true, true, true});
  CHECK(farthest_apart(frame->corners, tag.corners()) < 0.1);
}

TEST_CASE("a left or right side that is hidden is where the bars have it") {
  for (const bool left : {true, false}) {
    CAPTURE(left);
    SeenTag tag = bars_seen_aslant();
    tag.covers = {left ? PlaneCover{-80, -50, -52, 50, 0.4} : PlaneCover{52, -50, 80, 50, 0.4}};
    const auto frame = completed(tag);
    REQUIRE(frame);
    CHECK(frame->shown == std::array<bool, 4>{true, left, true, !left});
    CHECK(farthest_apart(frame->corners, tag.corners()) < 0.5);
    // What is known by the bars alone is less certain.
    const std::size_t hidden = left ? 3 : 1;
    CHECK(frame->sides[hidden].covariance(0, 0) > 0.05);
    CHECK(frame->sides[0].covariance(0, 0) < 0.01);
  }
}

TEST_CASE("an upper side that is hidden is where the bars' ends have it") {
  SeenTag tag = bars_seen_aslant();
  tag.covers = {{-80, -50, 80, tag.bars_top - 4, tag.white}};
  const auto frame = completed(tag);
  REQUIRE(frame);
  CHECK(frame->shown == std::array<bool, 4>{false, true, true, true});
  CHECK(farthest_apart(frame->corners, tag.corners()) < 1);
  CHECK(frame->sides[0].covariance(0, 0) > frame->sides[2].covariance(0, 0));
}

TEST_CASE("bars of which nothing around is a frame complete none") {
  SeenTag tag = bars_seen_aslant();
  tag.framed = false;
  tag.covers = {{-80, -50, 80, tag.bars_top + 5, 0.4}, {-80, tag.bars_bottom - 5, 80, 50, 0.4}};
  CHECK(!completed(tag));
  LocatedBars none;
  const GrayImage image = tag.image(), half = half_size(image.view());
  CHECK(!frame_by_bars(image.view(), half.view(), none, SymbolLayout{}));
}

TEST_CASE("around a symbol that was read the frame is fitted to a tenth of a pixel") {
  for (const double module_px : {1.4, 2.4}) {
    CAPTURE(module_px);
    SeenTag tag = bars_seen_aslant();
    tag.view.module_px = module_px;
    Quad expected = tag.corners();
    // As the bars have them, to a tenth of a module or so.
    expected[0].x += 0.2;
    expected[2].y -= 0.3;
    const auto frame = fitted(tag, expected);
    REQUIRE(frame);
    CHECK(frame->shown == std::array<bool, 4>{true, true, true, true});
    CHECK(farthest_apart(frame->corners, tag.corners()) < 0.1);
  }
}

TEST_CASE("an upper or lower edge off where the bars' ends put the frame is something else's") {
  for (const bool above : {true, false}) {
    CAPTURE(above);
    SeenTag tag = bars_seen_aslant();
    // A rod along the side, whose edge is 3.5 pixels inside the frame's own: more than the bars'
    // ends may be off by, which is two pixels here.
    const double inside = 3.5 / tag.view.module_px;
    tag.covers = {above ? PlaneCover{-80, SeenTag::kTop - 6, 80, SeenTag::kTop + inside, 0.05}
                        : PlaneCover{-80, tag.bottom() - inside, 80, tag.bottom() + 6, 0.05}};
    const auto frame = fitted(tag, tag.corners());
    REQUIRE(frame);
    CHECK(frame->shown == std::array<bool, 4>{!above, true, above, true});
    CHECK(farthest_apart(frame->corners, tag.corners()) < 1);
  }
}

TEST_CASE("a hidden side is placed by the bars' ends beside it alone, and by nothing less") {
  for (const bool above : {true, false}) {
    CAPTURE(above);
    SeenTag tag = bars_seen_aslant();
    const PlaneCover side = above ? PlaneCover{-80, -50, 80, tag.bars_top - 4, 0.6}
                                  : PlaneCover{-80, tag.bars_bottom + 4, 80, 50, 0.6};
    const PlaneCover other_ends =
        above ? PlaneCover{-80, tag.bars_bottom - 5, 80, tag.bars_bottom + 5, 0.2}
              : PlaneCover{-80, tag.bars_top - 5, 80, tag.bars_top + 5, 0.2};
    tag.covers = {side, other_ends};
    const auto frame = fitted(tag, tag.corners());
    REQUIRE(frame);
    CHECK(frame->shown == std::array<bool, 4>{!above, true, above, true});
    CHECK(farthest_apart(frame->corners, tag.corners()) < 1);
    const Eigen::Matrix2d& hidden = frame->sides[above ? 0 : 2].covariance;
    CHECK(std::min(hidden(0, 0), hidden(1, 1)) > 0.02);

    tag.covers.push_back(above ? PlaneCover{-80, -50, 80, tag.bars_top + 5, 0.2}
                               : PlaneCover{-80, tag.bars_bottom - 5, 80, 50, 0.2});
    CHECK(!fitted(tag, tag.corners()));
  }
}

TEST_CASE("a side that is not where the symbol has it is something else's") {
  // A cable with a clear edge inside the frame's own, by modules: farther off than the picture at
  // half its size tells, and nearer.
  for (const double inside : {2.0, 0.5}) {
    CAPTURE(inside);
    SeenTag tag = bars_seen_aslant();
    tag.covers = {{SeenTag::kLeft - 6, -50, SeenTag::kLeft + inside, 50, 0.05}};
    const auto frame = fitted(tag, tag.corners());
    REQUIRE(frame);
    CHECK(frame->shown == std::array<bool, 4>{true, true, true, false});
    CHECK(farthest_apart(frame->corners, tag.corners()) < 0.3);
  }
}
