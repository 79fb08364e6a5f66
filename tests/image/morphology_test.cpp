// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/morphology.hpp"

#include <cstddef>
#include <vector>

#include <doctest/doctest.h>

using tagsmith::detail::closed;

TEST_CASE("closing fills what is dark and narrow, and leaves the edges of what is wide") {
  //                              narrow dark   dark from here on, with a bright gap
  const std::vector<float> line{9, 9, 2, 3, 9, 9, 4, 4, 4, 4, 6, 4, 4};
  CHECK(closed(line, 1) == std::vector<float>{9, 9, 9, 9, 9, 9, 4, 4, 4, 4, 6, 4, 4});
  CHECK(closed(line, 0) == line);
}

TEST_CASE("closing a line shorter than the window leaves its greatest value") {
  CHECK(closed(std::vector<float>{1, 5, 2}, 7) == std::vector<float>{5, 5, 5});
  CHECK(closed({}, 3).empty());
}

TEST_CASE("closing never darkens, and closing again changes nothing") {
  std::vector<float> line;
  for (std::size_t i = 0; i < 200; ++i) line.push_back(static_cast<float>(i * 37 % 101));
  const std::vector<float> once = closed(line, 4);
  for (std::size_t i = 0; i < line.size(); ++i) CHECK(once[i] >= line[i]);
  CHECK(closed(once, 4) == once);
}
