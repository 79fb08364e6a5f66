// SPDX-License-Identifier: Apache-2.0
#include "decoder/feature_frame/side_line.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::farthest_apart;
using tagsmith::detail::test::PlaneView;

namespace {

const Quad kQuad{{{40, 50}, {300, 20}, {330, 190}, {30, 160}}};

std::array<SideLine, 4> sides_of(const Quad& quad) {
  return {side_of(quad, 0), side_of(quad, 1), side_of(quad, 2), side_of(quad, 3)};
}

}  // namespace

TEST_CASE("a side runs from corner to corner with the outside at its left") {
  const PixelPoint middle = centre_of(kQuad);
  for (std::size_t i = 0; i < 4; ++i) {
    CAPTURE(i);
    const SideLine side = side_of(kQuad, i);
    CHECK(distance(side.begin, kQuad[i]) == 0);
    CHECK(distance(side.end, kQuad[(i + 1) % 4]) == 0);
    CHECK(distance(side.begin + distance(side.begin, side.end) * side.along, side.end) < 1e-9);
    CHECK(length(side.outward) == doctest::Approx(1));
    CHECK(dot(side.outward, side.along) == doctest::Approx(0));
    CHECK(dot(side.outward, middle - side.begin) < 0);
    CHECK(distance(point_on(side, -1), side.begin) < 1e-9);
    CHECK(distance(point_on(side, 1), side.end) < 1e-9);
  }
}

TEST_CASE("a side's likely stroke is that of the plates, whichever way the symbol runs") {
  // Of four modules, of 113 by 55 inside.
  for (const bool upright : {false, true}) {
    const double across = upright ? 110 : 226, down = upright ? 226 : 110;
    const Quad quad{{{10, 10}, {10 + across, 10}, {10 + across, 10 + down}, {10, 10 + down}}};
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(side_of(quad, i).stroke == doctest::Approx(8).epsilon(0.03));
      // Neither beyond the stroke nor into the bars, which stand 9 modules inside.
      CHECK(side_of(quad, i).reach <= 8);
      CHECK(side_of(quad, i).reach >= 1.5);
    }
  }
}

TEST_CASE("a sagitta is nothing at the ends, and its slope is that of small changes") {
  const SideSagitta bow{{3, -0.7, 0.5, 0.9, -0.4}};
  CHECK(bow.at(-1) == 0);
  CHECK(bow.at(1) == 0);
  CHECK(bow.middle() == bow.at(0));
  CHECK(bow.at(0.5) == doctest::Approx(0.75 * (3 - 0.35 + 0.125 + 0.1125 - 0.025)));
  for (double s = -1; s <= 1; s += 0.125) {
    CAPTURE(s);
    CHECK(bow.slope(s) ==
          doctest::Approx((bow.at(s + 1e-5) - bow.at(s - 1e-5)) / 2e-5).epsilon(1e-6));
  }
  const SideSagittas twice = scaled(SideSagittas{bow, {}, bow, {}}, 2);
  CHECK(twice[2].at(0.3) == doctest::Approx(2 * bow.at(0.3)));
  CHECK(twice[1].is_straight());
}

TEST_CASE("the sides of a quadrilateral meet in its corners again") {
  const auto again = corners_of(sides_of(kQuad));
  REQUIRE(again);
  CHECK(farthest_apart(*again, kQuad) < 1e-9);
  // Sides that were moved outwards by as much at both ends meet in the widened one.
  std::array<SideLine, 4> sides = sides_of(kQuad);
  for (SideLine& side : sides) side = moved(side, 3, 3);
  const auto wider = corners_of(sides);
  REQUIRE(wider);
  CHECK(farthest_apart(*wider, widened(kQuad, 3)) < 1e-9);
}

TEST_CASE("a side that is moved at one end turns about the other") {
  const SideLine side = side_of(kQuad, 1);
  const SideLine turned = moved(side, 0, 5);
  CHECK(distance(turned.begin, side.begin) == 0);
  CHECK(dot(turned.end - side.end, side.outward) == doctest::Approx(5));
  CHECK(length(turned.along) == doctest::Approx(1));
  CHECK(std::abs(cross(turned.along, turned.end - turned.begin)) < 1e-9);
  CHECK(dot(turned.outward, turned.end - turned.begin) == doctest::Approx(0));
}

// A circle about the frame's middle bows all sides alike: their tangents meet outside the chords'.
TEST_CASE("sides that bow meet where their tangents do") {
  const Quad square{{{0, 0}, {100, 0}, {100, 100}, {0, 100}}};
  std::array<SideLine, 4> sides = sides_of(square);
  for (SideLine& side : sides) {
    side.bow.c[0] = 2;
    side = moved(side, 1, 1);
  }
  const auto corners = corners_of(sides);
  REQUIRE(corners);
  // At its end a chord of 100 pixels with a sagitta of 2 has the slope 2 * 2 * 2 / 100.
  const double beyond = 1.0 / (1 + 0.08);
  CHECK((*corners)[0].x == doctest::Approx(-beyond));
  CHECK((*corners)[0].y == doctest::Approx(-beyond));
  CHECK((*corners)[2].x == doctest::Approx(100 + beyond));
}

TEST_CASE("sides that run alike do not close") {
  std::array<SideLine, 4> sides = sides_of(kQuad);
  sides[1] = sides[0];
  CHECK(!corners_of(sides));
}

TEST_CASE("a stroke tapers as the plane's perspective has it") {
  const PlaneView view{{200, 150}, 2.5, 0.3, {0.004, -0.003}};
  const double x = 56.5, y = 27.5, stroke = 4;
  const auto corners_at = [&](double by) {
    return Quad{view.pixel({-x - by, -y - by}), view.pixel({x + by, -y - by}),
                view.pixel({x + by, y + by}), view.pixel({-x - by, y + by})};
  };
  const Quad inner = corners_at(0);
  const std::array<PixelPoint, 4> beyond{
      PixelPoint{0, -stroke}, {stroke, 0}, {0, stroke}, {-stroke, 0}};
  const std::array<PixelPoint, 4> in_plane{PixelPoint{-x, -y}, {x, -y}, {x, y}, {-x, y}};
  for (std::size_t i = 0; i < 4; ++i) {
    CAPTURE(i);
    const SideLine side = side_of(inner, i);
    const double begin = dot(view.pixel(in_plane[i] + beyond[i]) - side.begin, side.outward);
    const double end = dot(view.pixel(in_plane[(i + 1) % 4] + beyond[i]) - side.end, side.outward);
    const double expected = (end - begin) / (end + begin);
    CHECK(std::abs(expected) > 0.02);
    CHECK(taper_of(inner, side, i) == doctest::Approx(expected).epsilon(0.1));
  }
}
