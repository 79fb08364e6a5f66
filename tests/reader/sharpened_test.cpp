// SPDX-License-Identifier: Apache-2.0
// Tags in pictures as phones and webcams store them.
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <doctest/doctest.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/develop.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/bench/tag_trial.hpp"
#include "tests/support/corridor_template.hpp"

namespace tagsmith::detail {
namespace {

struct Seen {
  Digits code{};
  PlateTruth truth;
  std::vector<Reading> tags;
};

Seen seen_through(const std::optional<CameraChain>& chain, double module_px, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Camera camera;
  camera.width = camera.height = 340;
  camera.fx = camera.fy = 1600;
  camera.cx = camera.cy = 169.5;
  const Digits code = bench::random_code(random);
  std::uniform_real_distribution<double> any(0, 1);
  const ScenePlate plate = bench::plate_at(
      camera, draw_tag(test::corridor_template(), code),
      {{169 + any(random), 169 + any(random)}, module_px, 0.5 * any(random), 6.28 * any(random)});
  ViewOptions view;
  view.sensor.blur_sigma_px = 0.5;
  view.sensor.exposure = 0.85;
  view.seed = seed;
  if (chain) view.sensor = through_chain(view.sensor, *chain);
  const View picture = render_view(camera, std::span(&plate, 1), view);
  const auto stored = compressed(picture.image.view(), chain ? chain->jpeg_quality : 95);
  REQUIRE(stored);
  return {code, picture.plates.front(), read_tags(stored->view(), {}).tags};
}

// Of the corners against their covariance, per degree of freedom.
double chi_square(const Reading& reading, const PlateTruth& truth) {
  Eigen::Matrix<double, 8, 1> error;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto at = static_cast<Eigen::Index>(2 * i);
    error[at] = reading.corners[i].x - truth.corners[i]->x();
    error[at + 1] = reading.corners[i].y - truth.corners[i]->y();
  }
  return error.dot(reading.corner_covariance.ldlt().solve(error)) / 8;
}

// With the halos left in, the median is 0.08 and 0.15 px and the chi-squares are 7 and 12.
TEST_CASE("Halos move no corners, and the covariance holds what is left of them") {
  for (const std::string name : {"mild", "strong"}) {
    CAPTURE(name);
    int read = 0;
    double mean = 0;
    std::vector<double> errors;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      const Seen seen = seen_through(camera_chain(name), seed % 2 == 0 ? 1.2 : 1.5, 700 + seed);
      for (const Reading& tag : seen.tags) {
        REQUIRE(tag.digits == seen.code);
        ++read;
        for (const double error : bench::corner_errors(tag, seen.truth)) errors.push_back(error);
        mean += std::min(10.0, chi_square(tag, seen.truth)) / 12;
      }
    }
    REQUIRE(read >= 11);
    std::ranges::sort(errors);
    CHECK(errors[errors.size() / 2] < 0.03);
    CHECK(mean < 2.5);
  }
}

TEST_CASE("Tags are read at night that halos and noise hid") {
  int read = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Seen seen = seen_through(camera_chain("night"), 1.6, 800 + seed);
    for (const Reading& tag : seen.tags) {
      CHECK(tag.digits == seen.code);
      ++read;
    }
  }
  CHECK(read >= 6);
}

TEST_CASE("Nothing is undone in pictures that were not sharpened") {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Seen seen = seen_through(std::nullopt, 1.5, 900 + seed);
    REQUIRE(seen.tags.size() == 1);
    REQUIRE(seen.tags.front().symbol);
    CHECK(!seen.tags.front().symbol->frame.was_sharpened);
  }
}

}  // namespace
}  // namespace tagsmith::detail
