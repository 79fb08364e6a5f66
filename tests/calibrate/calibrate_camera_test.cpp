// SPDX-License-Identifier: Apache-2.0
#include "decoder/calibrate/calibrate_camera.hpp"

#include <Eigen/Cholesky>
#include <doctest/doctest.h>

#include "decoder/calibrate/ray_sigma.hpp"
#include "tests/support/board_photos.hpp"

using namespace tagsmith::detail;
using Eigen::Vector2d;
using test::Draws;

namespace {

struct NamedCamera {
  const char* name;
  Camera camera;
};

std::vector<NamedCamera> cameras() {
  return {
      {"no distortion", {1280, 960, 1100, 1100, 645.2, 473.1}},
      {"telephoto", {1280, 960, 6000, 6000, 630, 485, {-0.2}}},
      {"k1 0.05", {1280, 960, 1400, 1400, 650, 470, {0.05}}},
      {"k1 -0.35", {1280, 960, 800, 800, 633.5, 488, {-0.35, 0.12}}},
      {"tangential, two focal lengths",
       {1920, 1080, 1000, 1004, 980, 520, {-0.28, 0.09, 0.0012, -0.0009}}},
      {"rational", {1280, 960, 700, 700, 645, 474, {0.6, -0.02, 0, 0, 0.001, 0.95, 0.12, 0.004}}},
      {"fisheye of 180 degrees",
       {1280, 960, 400, 400, 645, 474, {-0.02, 0.004, -0.001, 0.0001}, LensModel::fisheye}},
      {"fisheye of 120 degrees",
       {1280, 960, 640, 640, 631, 484, {0.03, -0.02, 0, 0}, LensModel::fisheye}},
  };
}

// The largest distance, over the picture, between where a camera and its calibration see a ray.
double worst_ray(const Camera& truth, const CameraCalibration& calibration, double& worst_sigmas) {
  double worst = 0;
  for (int x = 0; x <= 10; ++x) {
    for (int y = 0; y <= 10; ++y) {
      const Vector2d pixel(x * (truth.width - 1) / 10.0, y * (truth.height - 1) / 10.0);
      const auto ray = ray_through(truth, pixel);
      if (!ray) continue;
      const auto seen = project(calibration.camera, *ray);
      if (!seen) continue;
      const auto sigma = ray_sigma_px(calibration, *seen);
      const double off = (*seen - pixel).norm();
      worst = std::max(worst, off);
      worst_sigmas = std::max(worst_sigmas, sigma ? off / *sigma : 0);
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("a camera is found without any guess, to within what it says of itself") {
  const Board board = test::plate_board();
  for (const NamedCamera& one : cameras()) {
    CAPTURE(one.name);
    Draws draws(7);
    const auto views = test::seen_boards(one.camera, board, 15, draws);
    const auto calibration = calibrate_camera(views, {&board, 1});
    REQUIRE(calibration.has_value());
    double sigmas = 0;
    const double worst = worst_ray(one.camera, *calibration, sigmas);
    CHECK(calibration->sigma_factor < 1.06);
    // A long lens looks almost the same wherever its axis is.
    CHECK(worst < (one.camera.fx > 5000 ? 10 : 0.3));
    CHECK(sigmas < 4);
    CHECK(std::abs(calibration->camera.fx - one.camera.fx) <
          3 * std::sqrt(calibration->covariance(0, 0)));
  }
}
