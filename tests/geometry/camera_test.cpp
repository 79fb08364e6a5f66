// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/camera.hpp"

#include <random>

#include <doctest/doctest.h>

using namespace tagsmith;

namespace {

Camera distorted_camera(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Camera camera = camera_from_sensor(1280, 960, 6.0, 4.8, 3.6);
  camera.fx *= 1 + 0.1 * unit(random);
  camera.cx += 20 * unit(random);
  camera.cy += 20 * unit(random);
  camera.distortion = {0.2 * unit(random), 0.1 * unit(random), 0.005 * unit(random),
                       0.005 * unit(random), 0.02 * unit(random)};
  return camera;
}

}  // namespace

TEST_CASE("the paper's lens and sensor are 1600 pixels of focal length") {
  const Camera camera = camera_from_sensor(1280, 960, 6.0, 4.8, 3.6);
  CHECK(camera.fx == doctest::Approx(1600));
  CHECK(camera.fy == doctest::Approx(1600));
  CHECK(camera.cx == 639.5);  // pixel (0, 0) is the centre of the upper left pixel
  CHECK(camera.cy == 479.5);
}

TEST_CASE("a point on the axis falls on the principal point, x to the right and y down") {
  Camera camera = camera_from_sensor(1280, 960, 6.0, 4.8, 3.6);
  const auto centre = project(camera, {0, 0, 2});
  REQUIRE(centre.has_value());
  CHECK(*centre == Eigen::Vector2d(639.5, 479.5));
  const auto pixel = project(camera, {0.1, 0.2, 2});
  REQUIRE(pixel.has_value());
  CHECK(pixel->x() == doctest::Approx(639.5 + 80));
  CHECK(pixel->y() == doctest::Approx(479.5 + 160));
}

TEST_CASE("distortion follows OpenCV's model") {
  // Worked out with a desk calculator from the formulas of OpenCV's calib3d documentation.
  Camera camera{2000, 2000, 1000, 1000, 0, 0, {-0.2, 0.05, 0.001, -0.002, 0.01}};
  const auto pixel = project(camera, {0.3, -0.2, 1});
  REQUIRE(pixel.has_value());
  CHECK(pixel->x() == doctest::Approx(291.720091).epsilon(1e-12));
  CHECK(pixel->y() == doctest::Approx(-194.523394).epsilon(1e-12));
}

TEST_CASE("projecting the ray through a pixel gives the pixel back, distortion included") {
  constexpr unsigned kSeed = 21;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> u(0, 1279);
  std::uniform_real_distribution<double> v(0, 959);
  std::uniform_real_distribution<double> depth(0.2, 20);
  for (int i = 0; i < 500; ++i) {
    const Camera camera = distorted_camera(random);
    const Eigen::Vector2d pixel(u(random), v(random));
    const auto again = project(camera, depth(random) * ray_through(camera, pixel));
    REQUIRE(again.has_value());
    CHECK((*again - pixel).norm() < 1e-6);
  }
}

TEST_CASE("nothing behind the camera or at its centre is projected") {
  const Camera camera = camera_from_sensor(1280, 960, 6.0, 4.8, 3.6);
  CHECK_FALSE(project(camera, {0, 0, -1}).has_value());
  CHECK_FALSE(project(camera, {0, 0, 0}).has_value());
  CHECK_FALSE(project(camera, {0.1, 0, 1e-4}).has_value());
}

TEST_CASE("the image reaches half a pixel beyond the outermost pixel centres") {
  const Camera camera = camera_from_sensor(1280, 960, 6.0, 4.8, 3.6);
  CHECK(in_image(camera, {-0.5, -0.5}));
  CHECK(in_image(camera, {1279.5, 959.5}));
  CHECK_FALSE(in_image(camera, {-0.51, 0}));
  CHECK_FALSE(in_image(camera, {0, 959.51}));
}
