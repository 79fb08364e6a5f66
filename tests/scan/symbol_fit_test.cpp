// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/symbol_fit.hpp"

#include <cmath>
#include <cstddef>

#include <doctest/doctest.h>

#include "tests/scan/made_profile.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

TEST_CASE("a module is seen where its picture has it, along a straight line where no bend may be") {
  const Digits digits = *parse_digits("019000700401");
  const ImagingModel image{.blur = 0.45, .shift = 0.2, .bend = -0.15};
  const ScanProfile profile = profile_of(digits, image, 1e-4);
  const SeenPlaces free = seen_places(profile, digits, {.blur = 0.45});
  const SeenPlaces straight = seen_places(profile, digits, {.blur = 0.45}, 1e-4);
  for (const double module : {0.0, 47.5, 95.0}) {
    CAPTURE(module);
    const Eigen::RowVector3d by = SeenPlaces::by_displacement(module);
    const auto variance = [&](const SeenPlaces& seen) {
      return (by * seen.covariance * by.transpose()).value();
    };
    CHECK(free.place_of(module) == doctest::Approx(image.place_of(module)).epsilon(1e-3));
    // The straight line that comes nearest: a parabola's mean is a third of its height at the ends.
    const double nearest = module + image.shift + image.bend / 3;
    CHECK(std::abs(straight.place_of(module) - nearest) < 0.03);
    CHECK(variance(straight) < variance(free));
  }
}

TEST_CASE("a symbol that is seen twice is lopsided towards the fainter one") {
  const Digits digits = *parse_digits("019000700401");
  constexpr double kBlur = 0.45, kShare = 0.25;
  for (const double apart : {0.5, -0.5}) {
    CAPTURE(apart);
    ScanProfile profile = profile_of(digits, {.blur = kBlur}, 1e-4);
    const ScanProfile faint = profile_of(digits, {.blur = kBlur, .shift = apart}, 1e-4);
    for (std::size_t i = 0; i < profile.size(); ++i) {
      profile[i].darkness += kShare * (faint[i].darkness - profile[i].darkness);
    }
    const SeenPlaces seen = seen_places(profile, digits, {.blur = kBlur});
    // The moments of the sum of two point spreads about their common mean.
    const double variance = kBlur * kBlur + kShare * (1 - kShare) * apart * apart;
    const double third = kShare * (1 - kShare) * (1 - 2 * kShare) * std::pow(apart, 3);
    CHECK(seen.lopsided == doctest::Approx(third / variance).epsilon(0.1));
    CHECK(seen.lopsided_sigma < std::abs(seen.lopsided) / 8);
  }
  const SeenPlaces once =
      seen_places(profile_of(digits, {.blur = kBlur}, 1e-4), digits, {.blur = 0.3});
  CHECK(std::abs(once.lopsided) < 1e-3);
}
