// SPDX-License-Identifier: Apache-2.0
#include "decoder/scan/running.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

namespace {

std::vector<float> random_line(std::size_t size) {
  std::mt19937 random(7);
  std::vector<float> line(size);
  for (float& sample : line) sample = static_cast<float>(random() % 1000) / 1000;
  return line;
}

}  // namespace

TEST_CASE("a sliding window shows what each window alone shows") {
  for (const std::size_t size : {1U, 2U, 7U, 40U, 91U, 333U}) {
    for (const std::size_t window : {0U, 1U, 3U, 15U, 45U, 400U}) {
      CAPTURE(size);
      CAPTURE(window);
      const std::vector<float> line = random_line(size);
      const std::vector<float> most = running_maximum(line, window);
      const std::vector<float> least = running_minimum(line, window);
      const std::vector<float> mean = running_mean(line, window);
      for (std::size_t i = 0; i < size; ++i) {
        const auto begin = line.begin() + static_cast<std::ptrdiff_t>(i - std::min(i, window));
        const auto end = line.begin() + static_cast<std::ptrdiff_t>(std::min(size, i + window + 1));
        CHECK(most[i] == *std::max_element(begin, end));
        CHECK(least[i] == *std::min_element(begin, end));
        const double sum = std::accumulate(begin, end, 0.0);
        CHECK(static_cast<double>(mean[i]) ==
              doctest::Approx(sum / static_cast<double>(end - begin)).epsilon(1e-6));
      }
    }
  }
}
