// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>

#include <doctest/doctest.h>

#include "decoder/simulate/sensor.hpp"

namespace tagsmith::detail {
namespace {

// White to the left of a column, black from it on, a pixel of grey between them.
LightImage edge_of_light(float white, float black) {
  LightImage light(160, 120, white);
  for (int y = 0; y < light.height; ++y) {
    float* row = light.row(y);
    row[80] = (white + black) / 2;
    std::fill(row + 81, row + light.width, black);
  }
  return light;
}

// The mean grey level of a column, the image's border left out.
double level_of_column(const GrayImage& image, int x) {
  double sum = 0;
  for (int y = 20; y < image.height - 20; ++y) sum += image.view().at(x, y);
  return sum / (image.height - 40);
}

GrayImage edge_through(CameraChain chain) {
  chain.noise_sigma = 0;
  SensorModel sensor;
  return develop(edge_of_light(0.5F, 0.04F), through_chain(sensor, chain), 3);
}

// How alike neighbouring pixels' deviations from the mean are, 0 to 1.
double likeness_of_neighbours(const GrayImage& image) {
  double mean = 0, own = 0, common = 0;
  for (const std::uint8_t sample : image.samples) mean += sample;
  mean /= static_cast<double>(image.samples.size());
  for (int y = 10; y < image.height - 10; ++y) {
    for (int x = 10; x < image.width - 10; ++x) {
      const double here = image.view().at(x, y) - mean;
      own += here * here;
      common += here * (image.view().at(x + 1, y) - mean);
    }
  }
  return common / own;
}

TEST_CASE("Sharpening leaves halos on both sides of an edge, more of them the stronger it is") {
  double before = 0;
  for (const char* name : {"mild", "strong"}) {
    CAPTURE(name);
    const GrayImage image = edge_through(camera_chain(name));
    double brightest = 0, darkest = 255;
    for (int x = 70; x < 90; ++x) {
      brightest = std::max(brightest, level_of_column(image, x));
      darkest = std::min(darkest, level_of_column(image, x));
    }
    const double over = brightest - level_of_column(image, 40);
    CHECK(over > before + 2);
    CHECK(level_of_column(image, 120) - darkest > before + 2);
    before = over;
  }
}

TEST_CASE("A chain that does nothing but demosaic keeps the grey levels of even light") {
  const SensorModel sensor = through_chain({}, {});
  const GrayImage image = develop(LightImage(64, 48, 0.21586F), sensor, 1);
  CHECK(std::ranges::all_of(image.samples, [](int level) { return std::abs(level - 128) <= 1; }));
}

TEST_CASE("Demosaicing and denoising make the noise of neighbouring pixels alike") {
  SensorModel sensor;
  sensor.noise_sigma = 6;
  const LightImage light(200, 160, 0.2F);
  CHECK(std::abs(likeness_of_neighbours(expose(light, sensor, 5))) < 0.05);
  CHECK(likeness_of_neighbours(develop(light, through_chain(sensor, CameraChain()), 5)) > 0.15);
  CameraChain smooth;
  smooth.denoise_levels = 25;
  smooth.denoise_px = 1.5;
  CHECK(likeness_of_neighbours(develop(light, through_chain(sensor, smooth), 5)) > 0.5);
}

TEST_CASE("Rows that are read one by one lean, and the truth leans with them") {
  CameraChain chain;
  chain.rolling_px = 12;
  const GrayImage image = edge_through(chain);
  const auto edge_in_row = [&](int y) {
    int x = 40;
    while (image.view().at(x, y) > 120) ++x;
    return x;
  };
  const double rows = 100 - 20, height = image.height - 1;
  CHECK(edge_in_row(100) - edge_in_row(20) == doctest::Approx(12 * rows / height).epsilon(0.15));
  PlateTruth truth;
  truth.corners[0] = Eigen::Vector2d(50, 0);
  truth.corners[2] = Eigen::Vector2d(50, height);
  roll_corners(truth, image.height, chain.rolling_px);
  CHECK(truth.corners[0]->x() == doctest::Approx(44));
  CHECK(truth.corners[2]->x() == doctest::Approx(56));
  CHECK(!truth.corners[1]);
}

TEST_CASE("A compressed picture differs, the less the higher the quality") {
  const GrayImage image = edge_through(camera_chain("strong"));
  const auto off = [&](int quality) {
    const auto stored = compressed(image.view(), quality);
    REQUIRE(stored);
    double sum = 0;
    for (std::size_t i = 0; i < image.samples.size(); ++i) {
      sum += std::abs(stored->samples[i] - image.samples[i]);
    }
    return sum / static_cast<double>(image.samples.size());
  };
  CHECK(off(50) > off(95));
  CHECK(off(95) > 0);
}

}  // namespace
}  // namespace tagsmith::detail
