// SPDX-License-Identifier: Apache-2.0
#include "decoder/simulate/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <doctest/doctest.h>

namespace tagsmith::detail {
namespace {

struct Moments {
  double mean = 0;
  double sigma = 0;
};

Moments moments_of(const GrayImage& image) {
  double sum = 0;
  double squares = 0;
  for (const std::uint8_t sample : image.samples) {
    sum += sample;
    squares += static_cast<double>(sample) * sample;
  }
  const auto count = static_cast<double>(image.samples.size());
  return {sum / count, std::sqrt(squares / count - sum * sum / count / count)};
}

// The curve as IEC 61966-2-1 writes it, unrounded; what noise takes below no light lies below the
// black level.
double curved_level(const SensorModel& sensor, double light) {
  const double share = std::min(light, 1.0);
  const double curve = sensor.tone == SensorTone::linear ? share
                       : share <= 0.0031308              ? 12.92 * share
                                            : 1.055 * std::pow(share, 1.0 / 2.4) - 0.055;
  return std::max(sensor.black_level + (sensor.white_level - sensor.black_level) * curve, 0.0);
}

Moments expose_flat(SensorModel sensor, double light) {
  return moments_of(expose(LightImage(300, 200, static_cast<float>(light)), sensor, 11));
}

TEST_CASE("The sRGB curve has its published values") {
  // 8-bit codes and their linear light, from IEC 61966-2-1's formula as tabulated everywhere.
  const std::pair<double, double> levels[] = {{0.0, 0},       {0.0003035, 1}, {0.05126946, 64},
                                              {0.21586, 128}, {1.0, 255},     {7.0, 255}};
  for (const auto& [light, level] : levels) {
    CAPTURE(light);
    CHECK(expose_flat(SensorModel{}, light).mean == level);
  }
}

TEST_CASE("Every grey level begins where the curve, rounded, says") {
  for (const SensorTone tone : {SensorTone::linear, SensorTone::srgb}) {
    SensorModel sensor;
    sensor.tone = tone;
    sensor.black_level = 12;
    sensor.white_level = 240;
    LightImage light(20001, 1);
    for (int i = 0; i < light.width; ++i) {
      light.row(0)[i] = static_cast<float>(-0.02 + 1.1 * i / 20000);
    }
    const GrayImage image = expose(light, sensor, 0);
    for (int i = 0; i < light.width; ++i) {
      const double exact = curved_level(sensor, static_cast<double>(light.row(0)[i]));
      const double error = image.samples[static_cast<std::size_t>(i)] - exact;
      if (std::abs(error) > 0.5 + 1e-9) {
        CAPTURE(light.row(0)[i]);
        CHECK(std::abs(error) <= 0.5);
      }
    }
    CHECK(image.samples.back() == 240);
  }
}

TEST_CASE("The noise has the given deviation at the middle grey level") {
  for (const SensorTone tone : {SensorTone::linear, SensorTone::srgb}) {
    for (const double sigma : {1.0, 3.0, 8.0}) {
      SensorModel sensor;
      sensor.tone = tone;
      sensor.noise_sigma = sigma;
      const double light = tone == SensorTone::linear ? 0.5 : 0.214041;
      const Moments found = expose_flat(sensor, light);
      CAPTURE(sigma);
      CHECK(found.mean == doctest::Approx(127.5).epsilon(0.01));
      // Rounding adds a twelfth.
      CHECK(found.sigma == doctest::Approx(std::sqrt(sigma * sigma + 1.0 / 12)).epsilon(0.02));
    }
  }
}

TEST_CASE("Photon noise grows with the square root of the light") {
  SensorModel sensor;
  sensor.tone = SensorTone::linear;
  sensor.noise_sigma = 4;
  sensor.read_noise_share = 0;
  const double quarter = expose_flat(sensor, 0.125).sigma;
  const double middle = expose_flat(sensor, 0.5).sigma;
  CHECK(middle / quarter == doctest::Approx(2).epsilon(0.02));
  sensor.read_noise_share = 1;
  CHECK(expose_flat(sensor, 0.125).sigma == doctest::Approx(middle).epsilon(0.02));
}

TEST_CASE("Exposure multiplies the light") {
  SensorModel sensor;
  sensor.tone = SensorTone::linear;
  sensor.exposure = 2;
  CHECK(expose_flat(sensor, 0.25).mean == doctest::Approx(128));
  CHECK(expose_flat(sensor, 0.9).mean == doctest::Approx(255));
}

TEST_CASE("The blur has the variance of pixel aperture and Gaussian together") {
  for (const int cells : {1, 2, 4, 8}) {
    for (const double sigma : {0.4, 0.7, 1.5, 3.0}) {
      if (sigma * cells < 1) continue;  // finer than the cells
      const BlurKernel kernel = blur_kernel(sigma, cells);
      const double middle = (static_cast<double>(kernel.weights.size()) - 1) / 2;
      double sum = 0;
      double variance = 0;
      for (std::size_t i = 0; i < kernel.weights.size(); ++i) {
        const double at = (static_cast<double>(i) - middle) / cells;
        sum += static_cast<double>(kernel.weights[i]);
        variance += static_cast<double>(kernel.weights[i]) * at * at;
      }
      variance += 1.0 / (12.0 * cells * cells);  // of the cells themselves
      CAPTURE(cells);
      CAPTURE(sigma);
      CHECK(sum == doctest::Approx(1).epsilon(1e-5));
      CHECK(variance == doctest::Approx(sigma * sigma + 1.0 / 12).epsilon(0.01));
    }
  }
}

TEST_CASE("Without blur a pixel is the plain mean of its cells") {
  const BlurKernel kernel = blur_kernel(0, 4);
  CHECK(kernel.radius_px == 0);
  REQUIRE(kernel.weights.size() == 4);
  for (const float weight : kernel.weights) CHECK(weight == doctest::Approx(0.25));
}

}  // namespace
}  // namespace tagsmith::detail
