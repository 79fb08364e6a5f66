// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/geometry/camera.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"

using namespace tagsmith::detail;
using Eigen::Vector2d;
using Eigen::Vector3d;

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

Camera rational_camera(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Camera camera = distorted_camera(random);
  camera.fx = camera.fy = 700;
  camera.distortion = {0.8 + 0.1 * unit(random),
                       0.1 + 0.05 * unit(random),
                       0.002 * unit(random),
                       0.002 * unit(random),
                       0.01,
                       0.9 + 0.1 * unit(random),
                       0.15 + 0.05 * unit(random),
                       0.02};
  return camera;
}

Camera fisheye_camera(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Camera camera = distorted_camera(random);
  camera.lens = LensModel::fisheye;
  camera.fx = camera.fy = 660 + 40 * unit(random);
  camera.distortion = {0.02 * unit(random), 0.01 * unit(random), 0.005 * unit(random),
                       0.001 * unit(random)};
  return camera;
}

// One of the kinds in turn.
Camera any_camera(int i, std::mt19937& random) {
  if (i % 3 == 0) return distorted_camera(random);
  return i % 3 == 1 ? rational_camera(random) : fisheye_camera(random);
}

// A camera, a place in its image, and a distance along the camera's axis, metres.
struct Sight {
  Camera camera;
  Vector2d pixel;
  double depth;
};

// Of all kinds of cameras, 900 in all.
std::vector<Sight> sights(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 1279);
  std::uniform_real_distribution<double> v(0, 959);
  std::uniform_real_distribution<double> depth(0.2, 20);
  std::vector<Sight> all;
  for (int i = 0; i < 900; ++i) {
    Sight sight{any_camera(i, random), {}, depth(random)};
    sight.pixel = {u(random), v(random)};
    all.push_back(sight);
  }
  return all;
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

TEST_CASE("the rational and the fisheye model are OpenCV's") {
  // From cv2.projectPoints and cv2.fisheye.projectPoints of OpenCV 4.6.
  Camera camera{1280, 960, 800, 805, 640, 480, {0.8, -0.3, 0.001, -0.0005, 0.05, 1.1, -0.2, 0.02}};
  CHECK((*project(camera, {0.3, -0.2, 1}) - Vector2d(871.225038087, 324.956303616)).norm() < 1e-8);
  CHECK((*project(camera, {1.2, 0.5, 1.5}) - Vector2d(1179.615583598, 706.975687452)).norm() <
        1e-8);
  camera.lens = LensModel::fisheye;
  camera.distortion = {-0.03, 0.01, -0.004, 0.0007};
  CHECK((*project(camera, {0.3, -0.2, 1}) - Vector2d(869.546746181, 326.012391103)).norm() < 1e-8);
  CHECK((*project(camera, {-2, 1, 0.9}) - Vector2d(-183.900184823, 894.524780489)).norm() < 1e-8);
}

TEST_CASE("projecting the ray through a pixel gives the pixel back, distortion included") {
  constexpr unsigned kSeed = 21;
  CAPTURE(kSeed);
  for (const auto& [camera, pixel, depth] : sights(kSeed)) {
    const auto ray = ray_through(camera, pixel);
    REQUIRE(ray.has_value());
    const auto again = project(camera, depth * *ray);
    REQUIRE(again.has_value());
    CHECK((*again - pixel).norm() < 1e-9);
  }
}

TEST_CASE("the derivative of the pixel is that of finite differences") {
  constexpr unsigned kSeed = 22;
  CAPTURE(kSeed);
  const std::vector<Sight> all = sights(kSeed);
  for (std::size_t i = 0; i < all.size(); ++i) {
    CAPTURE(i);
    auto [camera, pixel, depth] = all[i];
    // Every tenth point near the axis, where the formulas are replaced by their series.
    if (i % 10 == 0) pixel = {camera.cx + 1e-4 * pixel.x(), camera.cy};
    const Vector3d point = depth * ray_through(camera, pixel).value();
    const auto projection = project_with_derivative(camera, point);
    REQUIRE(projection.has_value());
    for (const int axis : {0, 1, 2}) {
      const Vector3d step = 1e-5 * point.z() * Vector3d::Unit(axis);
      const Vector2d by_difference =
          (*project(camera, point + step) - *project(camera, point - step)) / (2 * step.norm());
      CHECK((projection->by_point.col(axis) - by_difference).norm() <
            1e-5 * (1 + by_difference.norm()));
    }
    constexpr double kChange = 1e-6;
    Camera more = camera, less = camera;
    more.distortion[0] += kChange;
    less.distortion[0] -= kChange;
    const Vector2d by_k1 = (*project(more, point) - *project(less, point)) / (2 * kChange);
    CHECK((projection->by_k1 - by_k1).norm() < 1e-4 * (1 + by_k1.norm()));
  }
}

TEST_CASE("points that a distortion polynomial would fold back have no pixel") {
  Camera camera = camera_from_sensor(1280, 960, 3.0, 4.8, 3.6);
  CHECK(std::isinf(reach(camera)));
  camera.distortion = {-0.5};  // r (1 - r^2 / 2) rises up to r = sqrt(2/3)
  const double limit = std::sqrt(2.0 / 3);
  CHECK(reach(camera) == doctest::Approx(limit).epsilon(1e-12));
  CHECK(project(camera, {limit - 1e-6, 0, 1}).has_value());
  CHECK_FALSE(project(camera, {limit + 1e-6, 0, 1}).has_value());
  CHECK_FALSE(project(camera, {0, 1.4, 1}).has_value());  // would fall on the principal point
  const double highest = limit * (1 - limit * limit / 2);
  CHECK(ray_through(camera, {camera.cx + camera.fx * (highest - 1e-6), camera.cy}).has_value());
  CHECK_FALSE(
      ray_through(camera, {camera.cx + camera.fx * (highest + 1e-6), camera.cy}).has_value());
  // A dip after which the polynomial rises again: what lies beyond is out of reach all the same.
  camera.distortion = {-0.9, 0.3};
  CHECK(reach(camera) < 1);
  CHECK_FALSE(project(camera, {2, 0, 1}).has_value());
  // A pole of the rational model.
  camera.distortion = {0, 0, 0, 0, 0, -1, 0, 0};
  CHECK(reach(camera) < 1);
  CHECK_FALSE(project(camera, {1.5, 0, 1}).has_value());
}

TEST_CASE("a polynomial that dips without falling is followed to the end") {
  Camera camera = camera_from_sensor(1280, 960, 3.0, 4.8, 3.6);
  // The slope 1 + 3 k1 r^2 + 5 k2 r^4 is zero nowhere, or first at the smaller root.
  camera.distortion = {-0.9, 0.41};
  CHECK(reach(camera) == doctest::Approx(std::tan(radians(89.9))));
  CHECK(project(camera, {2, 0, 1}).has_value());
  for (const double k2 : {0.364, 0.3, 0.1, 0.01, 0.001}) {
    CAPTURE(k2);
    camera.distortion = {-0.9, k2};
    const double root = (2.7 - std::sqrt(2.7 * 2.7 - 20 * k2)) / (10 * k2);
    CHECK(reach(camera) == doctest::Approx(std::sqrt(root)).epsilon(1e-9));
  }
}

TEST_CASE("the derivative does not jump where a series takes its place near the axis") {
  constexpr unsigned kSeed = 23;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 3; ++i) {
    CAPTURE(i);
    const Camera camera = any_camera(i, random);
    const Vector3d inside(0.6 * (1e-3 - 1e-8), 0.8 * (1e-3 - 1e-8), 1);
    const Vector3d outside(0.6 * (1e-3 + 1e-8), 0.8 * (1e-3 + 1e-8), 1);
    const auto by_series = project_with_derivative(camera, inside);
    const auto by_quotient = project_with_derivative(camera, outside);
    CHECK((by_series->by_point - by_quotient->by_point).norm() < 1e-7 * camera.fx);
  }
}

TEST_CASE("a fisheye sees what lies before it up to 89.9 degrees from its axis, and no farther") {
  Camera camera = camera_from_sensor(1280, 960, 1.0, 4.8, 3.6);
  camera.lens = LensModel::fisheye;
  const auto at = [&](double angle_deg) {
    const double angle = radians(angle_deg);
    return project(camera, {std::sin(angle), 0, std::cos(angle)});
  };
  CHECK(at(60)->x() == doctest::Approx(camera.cx + camera.fx * radians(60)));
  CHECK(at(89.89).has_value());
  CHECK_FALSE(at(89.91).has_value());
  CHECK(ray_through(camera, {camera.cx + camera.fx * radians(89.8), camera.cy}).has_value());
  CHECK_FALSE(ray_through(camera, {0, 0}).has_value());  // outside of the image circle
  CHECK(ray_through(camera, {camera.cx, camera.cy}) == Vector3d(0, 0, 1));
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
