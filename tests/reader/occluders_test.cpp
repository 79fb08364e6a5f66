// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/occluders.hpp"

#include <doctest/doctest.h>

#include "decoder/feature_frame/quad.hpp"

namespace tagsmith::detail::test {

TEST_CASE("an occluder hides the places of a row that lie inside it") {
  // A cable that slants from the upper side to the lower one, and beyond both.
  const Occluder cable{{{0.30, -0.05}, {0.42, -0.05}, {0.62, 1.05}, {0.50, 1.05}}};
  for (const double v : {0.0, 0.213, 0.5, 0.997}) {
    CAPTURE(v);
    const HiddenWidth hidden = hidden_width(cable, v);
    CHECK(hidden.end - hidden.begin == doctest::Approx(0.12));
    for (int i = 0; i < 131; ++i) {
      const double u = (i + 0.5) / 131;
      CAPTURE(u);
      CHECK((hidden.begin <= u && u <= hidden.end) == contains(cable, {u, v}));
    }
  }
}

TEST_CASE("an occluder hides nothing above and below itself") {
  const Occluder board{{{0.2, 0.3}, {0.6, 0.3}, {0.6, 0.5}, {0.2, 0.5}}};
  for (const double v : {0.29, 0.51, 2.0}) {
    const HiddenWidth hidden = hidden_width(board, v);
    CHECK(hidden.end < hidden.begin);
  }
  const HiddenWidth within = hidden_width(board, 0.4);
  CHECK(within.begin == doctest::Approx(0.2));
  CHECK(within.end == doctest::Approx(0.6));
}

}  // namespace tagsmith::detail::test
