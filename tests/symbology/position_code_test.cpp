// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/symbology/position_code.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

using namespace tagsmith::detail;

TEST_CASE("the paper's positions have the paper's digits") {
  PositionCode code;
  code.check = CheckDigit::sum10;
  struct Case {
    GridPoint position;
    const char* digits;
  };
  const Case cases[] = {
      {{0.3, 3.0, 0.6}, "003003000602"},  // Xu et al. 2017, Fig 10
      {{1.9, 0.0, 0.4}, "019000000404"},  // Table 4, row 1
      {{0.0, 0.4, 0.4}, "000000400408"},
      {{1.9, 4.8, 0.4}, "019004800406"},
  };
  for (const Case& example : cases) {
    CAPTURE(example.digits);
    const auto encoded = encode_position(code, example.position);
    REQUIRE(encoded.has_value());
    CHECK(to_string(encoded->digits) == example.digits);
  }
}

TEST_CASE("coding rounds to the nearest unit and says by how much") {
  const PositionCode code;
  const auto encoded = encode_position(code, {0.0, 0.343, 0.345});
  REQUIRE(encoded.has_value());
  CHECK(encoded->rounding[1] == doctest::Approx(-0.003));
  CHECK(encoded->rounding[2] == doctest::Approx(0.005));  // a half rounds up
}

TEST_CASE("decoding an encoded position gives it back within half a unit") {
  std::mt19937 random(3);
  PositionCode code;
  code.digit_counts = {5, 3, 3};
  code.resolution = {0.05, 0.1, 0.01};
  code.origin = {-1000.0, 20.0, -5.0};
  for (int i = 0; i < 1000; ++i) {
    GridPoint position{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = coded_range(code, axis);
      position[static_cast<std::size_t>(axis)] =
          std::uniform_real_distribution<double>(low, high)(random);
    }
    const auto encoded = encode_position(code, position);
    REQUIRE(encoded.has_value());
    const GridPoint decoded = decode_position(code, encoded->digits);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CHECK(std::abs(decoded[axis] - position[axis]) <= code.resolution[axis] / 2 + 1e-6);
      CHECK(decoded[axis] - position[axis] == doctest::Approx(encoded->rounding[axis]));
    }
  }
}

TEST_CASE("what does not fit is named by its axis") {
  const PositionCode code;  // 99.99 x 99.99 x 9.99 m
  CHECK(axis_out_of_range(code, {-0.01, 0, 0}) == 0);
  CHECK(axis_out_of_range(code, {0, 100.0, 0}) == 1);
  CHECK(axis_out_of_range(code, {0, 0, 9.996}) == 2);
  CHECK(axis_out_of_range(code, {0, 0, std::numeric_limits<double>::quiet_NaN()}) == 2);
  CHECK_FALSE(axis_out_of_range(code, {99.99, 99.99, 9.99}).has_value());
  CHECK_FALSE(encode_position(code, {0, 100.0, 0}).has_value());
}
