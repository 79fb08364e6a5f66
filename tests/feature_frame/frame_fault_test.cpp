// SPDX-License-Identifier: Apache-2.0
// Each fault of an outline is told by its name.
#include <algorithm>

#include <doctest/doctest.h>

#include "decoder/feature_frame/coarse_fit.hpp"
#include "decoder/feature_frame/frame.hpp"
#include "decoder/feature_frame/refine.hpp"
#include "decoder/feature_frame/side_line.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::farthest_apart;
using tagsmith::detail::test::SeenTag;

namespace {

template <class T>
FrameFault fault_of(const FrameResult<T>& result) {
  REQUIRE(!result);
  return result.error();
}

}  // namespace

TEST_CASE("a frame that shows all around has no fault") {
  const SeenTag tag;
  const GrayImage image = tag.image();
  CHECK(looks_framed(image.view(), tag.corners()));
  const auto coarse = fit_frame_coarsely(image.view(), widened(tag.corners(), 1.5));
  REQUIRE(coarse);
  CHECK(farthest_apart(coarse->corners, tag.corners()) < 0.75);
  const auto refined = refine_frame(image.view(), coarse->corners);
  REQUIRE(refined);
  CHECK(farthest_apart(refined->corners, tag.corners()) < 0.05);
}

TEST_CASE(
    "a frame whose stroke the picture's border cuts is one, an outline at the border is not") {
  const SeenTag tag;
  const GrayImage image = tag.image();
  const Quad corners = tag.corners();
  const double right = std::min(corners[1].x, corners[2].x);
  const auto as_far_as = [&](double x) {
    GrayView view = image.view();
    view.width = static_cast<int>(x);
    return view;
  };
  const double stroke = side_of(corners, 1).stroke;
  CHECK(looks_framed(as_far_as(right + 0.75 * stroke), corners));
  CHECK_FALSE(looks_framed(as_far_as(right + 1), corners));
}

TEST_CASE("a side of which one end is hidden is settled by what shows of it") {
  SeenTag tag;
  // Two fifths of the left side and of the right one are painted over, at the lower end.
  tag.covers = {{-70, 7, -55, 40, tag.white}, {55, 7, 70, 40, tag.white}};
  const GrayImage image = tag.image();
  const auto coarse = fit_frame_coarsely(image.view(), widened(tag.corners(), 1.2));
  REQUIRE(coarse);
  CHECK(farthest_apart(coarse->corners, tag.corners()) < 1);
  const auto settled = settle_shown_sides(image.view(), widened(tag.corners(), 1.2));
  REQUIRE(settled);
  CHECK(settled->shown == std::array<bool, 4>{true, true, true, true});
  CHECK(farthest_apart(settled->quad, tag.corners()) < 1);
}

TEST_CASE("an outline of which a side shows no edge is faulted for that") {
  SeenTag tag;
  tag.covers = {{-70, -40, -55, 40, tag.white}};  // the left side is painted over
  CHECK(fault_of(fit_frame_coarsely(tag.image().view(), tag.corners())) == FrameFault::no_edge);
  CHECK(!looks_framed(tag.image().view(), tag.corners()));
}

TEST_CASE("an outline too small to be fitted is faulted for its short sides") {
  const GrayImage image = SeenTag().image();
  const Quad quad{{{40, 40}, {44, 40}, {44, 43}, {40, 43}}};
  CHECK(fault_of(refine_frame(image.view(), quad)) == FrameFault::side_too_short);
}

TEST_CASE("an outline with a side far from the edge is faulted for what cannot be fitted there") {
  const SeenTag tag;
  Quad quad = tag.corners();
  quad[0].y += 5;
  quad[1].y += 5;
  CHECK(fault_of(refine_frame(tag.image().view(), quad)) == FrameFault::no_fit);
}

TEST_CASE("a frame of which fewer than two sides show is faulted as covered") {
  const SeenTag tag;
  const GrayImage image = tag.image();
  for (std::size_t side = 0; side < 4; ++side) {
    CAPTURE(side);
    std::array<bool, 4> shown{};
    shown[side] = true;
    CHECK(fault_of(refine_shown_sides(image.view(), tag.corners(), shown, 0.5)) ==
          FrameFault::covered);
    shown[(side + 1) % 4] = true;
    CHECK(refine_shown_sides(image.view(), tag.corners(), shown, 0.5));
  }
}
