// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <doctest/doctest.h>

#include "decoder/reader/robust_profile.hpp"
#include "tagsmith/symbology/upca.hpp"

using namespace tagsmith::detail;

namespace {

// Distance between lines along the bars at half the frame's height, a thousandth of a module apart,
// in modules.
double width_of_module(const FrameHomography& map, double at, const SymbolLayout& layout) {
  constexpr double kStep = 1e-3;
  const double modules = kModuleCount + 2 * layout.quiet_zone_modules;
  const double u = (at + layout.quiet_zone_modules) / modules;
  const PixelPoint along = map(u, 0.501) - map(u, 0.499);
  const PixelPoint across = map(u + kStep / modules, 0.5) - map(u, 0.5);
  return std::abs(cross(across, along)) / std::hypot(along.x, along.y) / kStep;
}

}  // namespace

TEST_CASE("one blur in pixels spreads over more modules where they are narrow") {
  // The right side is twice as far away as the left one; sides bow in the second case.
  const Quad corners{{{100, 100}, {380, 180}, {390, 250}, {105, 260}}};
  const SymbolLayout layout;
  for (const double lambda : {0.0, -4e-7}) {
    CAPTURE(lambda);
    const FrameHomography map(
        corners, lambda == 0 ? LensDistortion() : LensDistortion::radial({640, 480}, lambda));
    ScanProfile profile;
    for (double at = -4; at < 99; at += 0.37) profile.push_back({.at = at});
    set_spreads(map, layout, profile);
    const double middle = width_of_module(map, kModuleCount / 2.0, layout);
    for (const ScanBin& bin : profile) {
      CAPTURE(bin.at);
      const double expected = middle / width_of_module(map, bin.at, layout);
      CHECK(bin.spread == doctest::Approx(expected).epsilon(1e-4));
    }
    CHECK(profile.back().spread > 1.4 * profile.front().spread);
  }
}

TEST_CASE("a profile without places has no spreads to set") {
  ScanProfile profile;
  set_spreads(FrameHomography({{{0, 0}, {9, 0}, {9, 5}, {0, 5}}}, LensDistortion()), {}, profile);
  CHECK(profile.empty());
}
