// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/located_bars.hpp"

#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::SeenTag;

namespace {

SeenTag bare_symbol(double turn, PixelPoint slant) {
  SeenTag tag;
  tag.framed = false;
  tag.width = 420;
  tag.height = 260;
  tag.view = {{210, 130}, 2.5, turn, slant};
  return tag;
}

std::optional<LocatedBars> located(const SeenTag& tag) {
  const GrayImage image = tag.image();
  SampledLight light(image.view());
  return locate_bars(light, tag.region());
}

}  // namespace

TEST_CASE("the module of every pixel among the bars is found, however the plane is seen") {
  for (const double turn : {0.0, 0.35, -0.2}) {
    for (const PixelPoint slant : {PixelPoint{}, {0.002, 0}, {-0.001, 0.003}}) {
      CAPTURE(turn);
      CAPTURE(slant.y);
      const SeenTag tag = bare_symbol(turn, slant);
      const auto bars = located(tag);
      REQUIRE(bars);
      for (const double module : {0.0, 20.0, 47.5, 80.0, 95.0}) {
        for (const double y : {-15.0, 0.0, 15.0}) {
          const PixelPoint pixel = tag.view.pixel({module - 47.5, y});
          CHECK(std::abs(bars->module_of(pixel) - module) < 0.4);
          // The line of all pixels of that module passes by as near.
          const PixelPoint normal = bars->normal_at(module);
          const double off = dot(normal, pixel - bars->centre) + bars->distance_at(module);
          CHECK(std::abs(off) < 0.4);
        }
      }
      CHECK(bars->height == doctest::Approx(tag.region().height).epsilon(0.2));
    }
  }
}

TEST_CASE("the line of a module is the pixels that have it") {
  const LocatedBars bars{40, {0.3, 0.05}, {0.0004, -0.0007}, {200, 100}, 60};
  for (const double module : {0.0, 33.0, 95.0}) {
    const PixelPoint normal = bars.normal_at(module);
    const PixelPoint along = 1 / length(normal) * PixelPoint{-normal.y, normal.x};
    const PixelPoint nearest =
        bars.centre - bars.distance_at(module) / dot(normal, normal) * normal;
    for (const double down : {-30.0, 0.0, 45.0}) {
      CHECK(bars.module_of(nearest + down * along) == doctest::Approx(module).epsilon(1e-9));
    }
  }
}

TEST_CASE("what is not much like a symbol is not located") {
  SeenTag tag = bare_symbol(0, {});
  tag.covers = {{-60, -40, 60, 40, 0.4}};
  CHECK(!located(tag));
  tag.covers = {{-35, -40, -20, 40, 0.05}, {10, -40, 30, 40, 0.05}};
  CHECK(!located(tag));
}
