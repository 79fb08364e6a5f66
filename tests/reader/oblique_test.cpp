// SPDX-License-Identifier: Apache-2.0
// Tags seen from the side, out of focus.
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/corridor_template.hpp"
#include "tests/support/turned_plate.hpp"

using namespace tagsmith::detail;

namespace {

const Digits kCode = *parse_digits("019000800402");

// A tag from 2.5 metres away, so that modules at the near end are much wider, turned by so many
// degrees, as a camera sees it that shows its modules so wide.
ReadResult read_turned(double degrees, double module_px, double blur_px,
                       std::vector<Digits> code_book = {}) {
  constexpr double kDistance = 2.5;
  const double cosine = std::cos(radians(degrees));
  Camera camera;
  camera.width = 320;
  camera.height = static_cast<int>(200 / cosine);
  ScenePlate plate;
  plate.drawing = draw_tag(test::corridor_template(), kCode);
  camera.fx = camera.fy = module_px / plate.drawing.module * kDistance / cosine;
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  plate.camera_from_plate =
      camera_from_turned_plate(camera, plate.drawing, Eigen::Vector2d(camera.cx, camera.cy),
                               kDistance, radians(degrees), 0, 0.05);
  ViewOptions options;
  options.sensor.noise_sigma = 4;
  options.sensor.blur_sigma_px = blur_px;
  const View view = render_view(camera, std::span(&plate, 1), options);
  ReadOptions read_options;
  read_options.check = CheckDigit::sum10;
  read_options.code_book = std::move(code_book);
  return read_tags(view.image.view(), read_options);
}

}  // namespace

TEST_CASE("a blurred tag is read as well from the side as from the front") {
  for (const double degrees : {0.0, 45.0, 60.0, 75.0, -75.0}) {
    CAPTURE(degrees);
    const ReadResult result = read_turned(degrees, 1.2, 1.4);
    REQUIRE(result.tags.size() == 1);
    CHECK(result.tags[0].digits == kCode);
    CHECK(result.tags[0].confidence > 1 - 1e-7);
  }
}

TEST_CASE(
    "most frames whose sides are two pixels thick are read where the plate ends beside them") {
  int read = 0;
  for (const double degrees : {76.0, 79.0, 82.0, -79.0}) {
    for (const double module_px : {0.4, 0.42, 0.45}) {
      CAPTURE(degrees);
      CAPTURE(module_px);
      const ReadResult result = read_turned(degrees, module_px, 0.35);
      for (const Reading& tag : result.tags) CHECK(tag.digits == kCode);
      read += result.tags.empty() ? 0 : 1;
    }
  }
  CHECK(read >= 10);  // of 12
}

TEST_CASE("sharp frames with strokes half as thick as their outline suggests are read") {
  for (const double degrees : {76.0, 79.0, 82.0, -76.0, -79.0, -82.0}) {
    for (const double module_px : {0.82, 0.84, 0.86, 0.88}) {
      CAPTURE(degrees);
      CAPTURE(module_px);
      const ReadResult result = read_turned(degrees, module_px, 0.35);
      REQUIRE(result.tags.size() == 1);
      CHECK(result.tags[0].digits == kCode);
      CHECK(result.tags[0].method == ReadingMethod::frame);
    }
  }
}

TEST_CASE("frames whose thin sides show little are found around bars that run together") {
  int read = 0;
  for (const double degrees : {68.0, 70.0, 73.0, -70.0}) {
    for (const double module_px : {0.63, 0.65, 0.67}) {
      CAPTURE(degrees);
      CAPTURE(module_px);
      const ReadResult result = read_turned(degrees, module_px, 1.4, {kCode});
      for (const Reading& tag : result.tags) CHECK(tag.digits == kCode);
      read += result.tags.empty() ? 0 : 1;
    }
  }
  CHECK(read >= 10);  // of 12
}
