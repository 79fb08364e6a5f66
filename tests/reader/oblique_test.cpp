// SPDX-License-Identifier: Apache-2.0
// Tags seen from the side, out of focus.
#include <cmath>
#include <span>

#include <doctest/doctest.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith::detail;

TEST_CASE("a blurred tag is read as well from the side as from the front") {
  constexpr double kModulePx = 1.2, kBlurPx = 1.4;
  constexpr double kDistance = 2.5;  // metres: modules at the near end are much wider
  const std::string code = "019000800402";
  for (const double degrees : {0.0, 45.0, 60.0, 75.0, -75.0}) {
    CAPTURE(degrees);
    const double cosine = std::cos(radians(degrees));
    Camera camera;
    camera.width = 320;
    camera.height = static_cast<int>(200 / cosine);
    ScenePlate plate;
    plate.drawing = draw_tag(test::corridor_template(), *parse_digits(code));
    camera.fx = camera.fy = kModulePx / plate.drawing.module * kDistance / cosine;
    camera.cx = (camera.width - 1) / 2.0;
    camera.cy = (camera.height - 1) / 2.0;
    plate.camera_from_plate =
        camera_from_turned_plate(camera, plate.drawing, Eigen::Vector2d(camera.cx, camera.cy),
                                 kDistance, radians(degrees), 0, 0.05);
    ViewOptions options;
    options.sensor.noise_sigma = 4;
    options.sensor.blur_sigma_px = kBlurPx;
    const View view = render_view(camera, std::span(&plate, 1), options);
    ReadOptions read_options;
    read_options.check = CheckDigit::sum10;
    const ReadResult result = read_tags(view.image.view(), read_options);
    REQUIRE(result.tags.size() == 1);
    CHECK(to_string(result.tags[0].digits) == code);
    CHECK(result.tags[0].confidence > 1 - 1e-7);
  }
}
