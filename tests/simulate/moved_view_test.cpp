// SPDX-License-Identifier: Apache-2.0
// What the camera's motion does to walls, and where a plate is put and seen.
#include <algorithm>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/turned_plate.hpp"

namespace tagsmith::detail {
namespace {

constexpr int kWidth = 200;
constexpr int kHeight = 40;

Camera wall_camera() {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 300;
  camera.cx = (kWidth - 1) / 2.0;
  camera.cy = (kHeight - 1) / 2.0;
  return camera;
}

// The light of a wall, bright in its first columns, while the camera moves.
LightImage moving_past(int bright_columns, const Eigen::Vector2d& motion_px) {
  Backdrop backdrop{LightImage(kWidth, kHeight, 0.1F), LightImage(kWidth, kHeight, 5.0F)};
  for (int y = 0; y < kHeight; ++y) std::fill_n(backdrop.light.row(y), bright_columns, 0.9F);
  ViewOptions options;
  options.sensor.tone = SensorTone::linear;
  options.sensor.motion_px = motion_px;
  return render_light(wall_camera(), {}, options, &backdrop);
}

}  // namespace

TEST_CASE("motion smears the wall evenly along its way, and only along it") {
  const LightImage light = moving_past(100, {16, 0});
  const float* row = light.row(kHeight / 2);
  CHECK(row[88] == doctest::Approx(0.9));
  CHECK(row[111] == doctest::Approx(0.1));
  for (int x = 94; x <= 105; ++x) {
    CAPTURE(x);
    CHECK(row[x] == doctest::Approx(0.5 - 0.8 * (x - 99.5) / 16).epsilon(0.03));
  }
  const LightImage down = moving_past(100, {0, 16});
  CHECK(down.row(kHeight / 2)[95] == doctest::Approx(0.9));
  CHECK(down.row(kHeight / 2)[104] == doctest::Approx(0.1));
}

TEST_CASE("beyond the picture's border the wall goes on as it ends") {
  // The first column sees itself and what is left of it for half of the way.
  const LightImage light = moving_past(1, {20, 0});
  CHECK(light.row(kHeight / 2)[0] == doctest::Approx(0.1 + 0.8 * 10.5 / 20).epsilon(0.03));
}

TEST_CASE("a turned plate's frame has its middle at the pixel and distance asked for") {
  const Camera camera = wall_camera();
  const TagDrawing tag = draw_tag(test::corridor_template(), *parse_digits("012345678905"));
  const Rectangle& frame = tag.frame_inner;
  const Eigen::Vector3d middle(frame.x + frame.width / 2, frame.y + frame.height / 2, 0);
  for (const double yaw : {0.0, 30.0, -50.0}) {
    const Pose pose =
        camera_from_turned_plate(camera, tag, {60, 15}, 1.7, radians(yaw), radians(10), 0.3);
    CHECK((pose * middle).norm() == doctest::Approx(1.7));
    const auto pixel = project(camera, pose * middle);
    REQUIRE(pixel);
    CHECK((*pixel - Eigen::Vector2d(60, 15)).norm() < 1e-6);
  }
}

TEST_CASE("half of a frame is seen where something covers its other half") {
  Camera camera = wall_camera();
  camera.height = kWidth;
  camera.cy = camera.cx;
  const TagDrawing tag = draw_tag(test::corridor_template(), *parse_digits("012345678905"));
  const Rectangle& frame = tag.frame_outer;
  const double above = frame.y - 0.05, left = frame.x - 0.05;
  for (const Rectangle& area : {Rectangle{left, above, 2, 0.05 + frame.height / 2},
                                Rectangle{left, above + 0.05 + frame.height / 2, 2, 2},
                                Rectangle{left, above, 0.05 + frame.width / 2, 2}}) {
    ScenePlate plate{
        tag, camera_from_turned_plate(camera, tag, {camera.cx, camera.cy}, 1.5, 0, 0, 0), {}};
    plate.finish.cover = Cover{area, 0.15};
    const std::vector<ScenePlate> plates{plate};
    CHECK(plate_truths(camera, plates, nullptr).front().visible_fraction == 0.5);
  }
}

}  // namespace tagsmith::detail
