// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/reader/searched_image.hpp"

using namespace tagsmith::detail;

namespace {

// IEC 61966-2-1.
double light_of(int sample) {
  const double s = sample / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

}  // namespace

TEST_CASE("rows hold the light of their samples, also of a part of a picture") {
  constexpr int kWidth = 16, kStride = 20, kRows = 16;
  std::vector<std::uint8_t> samples;
  for (int i = 0; i < kStride * kRows; ++i) samples.push_back(static_cast<std::uint8_t>(i % 256));
  const GrayView part{samples.data() + 3, kWidth, kRows, kStride};
  SampledLight light(part);
  CHECK(light.width() == kWidth);
  CHECK(light.height() == kRows);
  light.make_rows(-5, 2);
  light.make_rows(2, 40);
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      CHECK(static_cast<double>(light.row(y)[x]) ==
            doctest::Approx(light_of(part.at(x, y))).epsilon(1e-5));
    }
  }
}

TEST_CASE("a row is made once, when it is first wanted") {
  std::vector<std::uint8_t> samples(40, 100);
  SampledLight light({samples.data(), 10, 4, 10});
  light.make_rows(1, 1);
  const float* const row = light.row(1);
  samples.assign(40, 200);
  light.make_rows(0, 3);
  CHECK(light.row(1) == row);
  CHECK(static_cast<double>(light.row(1)[5]) == doctest::Approx(light_of(100)).epsilon(1e-5));
  for (const int y : {0, 2, 3}) {
    CHECK(static_cast<double>(light.row(y)[5]) == doctest::Approx(light_of(200)).epsilon(1e-5));
  }
}
