// SPDX-License-Identifier: Apache-2.0
#include "decoder/reader/cover_strips.hpp"

#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/feature_frame/quad.hpp"

namespace tagsmith::test {

TEST_CASE("a strip covers the places of a row that lie inside it, and adds to those covered") {
  // A cable that slants from the upper side to the lower one, and beyond both.
  const CoverStrip strip{{{0.30, -0.05}, {0.42, -0.05}, {0.62, 1.05}, {0.50, 1.05}}};
  std::vector<double> places;
  for (int i = 0; i < 131; ++i) places.push_back((i + 0.5) / 131);
  for (const double v : {0.0, 0.213, 0.5, 0.997}) {
    CAPTURE(v);
    std::vector<std::int64_t> covered(places.size());
    covered.front() = 1;  // by another
    add_covered(strip, v, places, covered);
    CHECK(covered.front() == 1);
    int count = 0;
    for (std::size_t i = 1; i < places.size(); ++i) {
      CAPTURE(places[i]);
      CHECK((covered[i] != 0) == contains(strip, {places[i], v}));
      count += covered[i] != 0 ? 1 : 0;
    }
    CHECK(count >= 15);  // 0.12 of 131 places
    CHECK(count <= 16);
  }
}

}  // namespace tagsmith::test
