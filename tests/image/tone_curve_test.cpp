// SPDX-License-Identifier: Apache-2.0
#include "decoder/image/tone_curve.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

namespace tagsmith::detail {

TEST_CASE("the curve is sRGB's: light of known samples, and there and back the same") {
  const ToneCurve& curve = ToneCurve::srgb();
  // IEC 61966-2-1, by its formulas: straight up to a sample of 10, a power of 2.4 beyond.
  CHECK(curve.light_of(0) == 0);
  CHECK(curve.light_of(255) == doctest::Approx(1));
  CHECK(curve.light_of(10) == doctest::Approx(10 / 255.0 / 12.92));
  CHECK(curve.light_of(128) == doctest::Approx(0.21586));
  CHECK(curve.light_of(188) == doctest::Approx(0.50289));
  for (int sample = 0; sample < 256; ++sample) {
    CAPTURE(sample);
    CHECK(std::abs(curve.sample_of(curve.light_of(sample)) - sample) < 0.02);
    const auto point = curve.point_of(static_cast<float>(curve.light_of(sample)));
    CHECK(std::abs(point.sample - static_cast<float>(sample)) < 0.02);
  }
  CHECK(curve.sample_of(-1) == 0);
  CHECK(curve.sample_of(2) == doctest::Approx(255));
}

TEST_CASE("the slope is that of the samples") {
  for (const float light : {0.001F, 0.02F, 0.3F, 0.9F}) {
    CAPTURE(light);
    const float step = 0.0008F;
    const auto at = [](float place) { return ToneCurve::srgb().point_of(place); };
    const float slope = (at(light + step).sample - at(light - step).sample) / (2 * step);
    CHECK(at(light).slope == doctest::Approx(slope).epsilon(0.02));
  }
}

TEST_CASE("light out of range, or that is no number, has the curve's ends") {
  const ToneCurve& curve = ToneCurve::srgb();
  CHECK(curve.point_of(-3).sample == 0);
  CHECK(static_cast<double>(curve.point_of(7).sample) == doctest::Approx(255));
  CHECK(curve.point_of(std::numeric_limits<float>::quiet_NaN()).sample == 0);
}

TEST_CASE("a negative's light is what its picture's lacks") {
  const std::vector<std::uint8_t> sample{0};
  const ToneCurve& negative = ToneCurve::of({sample.data(), 1, 1, 1, true});
  CHECK(&ToneCurve::of({sample.data(), 1, 1, 1, false}) == &ToneCurve::srgb());
  for (int value = 0; value < 256; ++value) {
    CAPTURE(value);
    CHECK(negative.light_of(255 - value) ==
          doctest::Approx(1 - ToneCurve::srgb().light_of(value)).epsilon(1e-9));
    CHECK(std::abs(negative.sample_of(negative.light_of(value)) - value) < 0.02);
  }
}

}  // namespace tagsmith::detail
