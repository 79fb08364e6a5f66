// SPDX-License-Identifier: Apache-2.0
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/base/statistics.hpp"

using namespace tagsmith::detail;

TEST_CASE("residuals that are alike in runs raise a variance by the runs' length, others do not") {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  for (const std::size_t run : {1U, 2U, 5U}) {
    CAPTURE(run);
    std::vector<float> residuals(20'000);
    float value = 0;
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      if (i % run == 0) value = normal(random);
      residuals[i] = value;
    }
    CHECK(correlation_factor(residuals) == doctest::Approx(static_cast<double>(run)).epsilon(0.08));
  }
}

TEST_CASE("residuals that alternate, that are zero or none raise nothing") {
  std::vector<float> alternating;
  for (int i = 0; i < 50; ++i) alternating.push_back(i % 2 == 0 ? 1.0F : -1.0F);
  CHECK(correlation_factor(alternating) == 1);
  CHECK(correlation_factor(std::vector<float>(10, 0.0F)) == 1);
  CHECK(correlation_factor({}) == 1);
}
