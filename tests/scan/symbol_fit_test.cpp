// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/symbol_fit.hpp"

#include <doctest/doctest.h>

#include "tests/scan/made_profile.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

TEST_CASE("a module is seen where its picture has it, along a straight line where no bend may be") {
  const Digits digits = *parse_digits("019000700401");
  const ImagingModel image{.blur = 0.45, .shift = 0.2, .bend = -0.15};
  const ScanProfile profile = profile_of(digits, image, 1e-4);
  for (const double module : {0.0, 47.5, 95.0}) {
    CAPTURE(module);
    const SeenModule free = seen_module(profile, digits, {.blur = 0.45}, module, 10);
    CHECK(free.at == doctest::Approx(image.place_of(module)).epsilon(1e-3));
    // The straight line that comes nearest: a parabola's mean is a third of its height at the ends.
    const SeenModule straight = seen_module(profile, digits, {.blur = 0.45}, module, 1e-4);
    CHECK(std::abs(straight.at - (module + image.shift + image.bend / 3)) < 0.03);
    CHECK(straight.variance < free.variance);
  }
}
