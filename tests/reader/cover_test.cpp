// SPDX-License-Identifier: Apache-2.0
// Tags with something in front of a part of their bars' height.
#include <algorithm>
#include <span>
#include <string>

#include <doctest/doctest.h>

#include "decoder/reader/reader.hpp"
#include "decoder/simulate/render_view.hpp"
#include "tagsmith/tag/drawing.hpp"
#include "tests/support/corridor_template.hpp"

using namespace tagsmith;

namespace {

constexpr const char* kCode = "019002400404";

// The tag at 3 px a module, seen squarely.
ReadResult read_covered(const Cover& cover) {
  Camera camera;
  camera.width = 480;
  camera.height = 340;
  camera.fx = camera.fy = 1600;
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  ScenePlate plate;
  plate.drawing = draw_tag(test::corridor_template(), *parse_digits(kCode));
  plate.finish.cover = cover;
  const double distance = camera.fx * plate.drawing.module / 3;
  plate.camera_from_plate = camera_from_turned_plate(camera, plate.drawing, {camera.cx, camera.cy},
                                                     distance, 0.3, 0.1, 0.2);
  ViewOptions view;
  view.sensor.noise_sigma = 2;
  ReadOptions options;
  options.check = CheckDigit::gs1;
  return read_tags(render_view(camera, std::span(&plate, 1), view).image.view(), options);
}

}  // namespace

TEST_CASE("a board before the upper third of the bars hides nothing") {
  for (const double reflectance : {0.05, 0.3, 0.9}) {
    CAPTURE(reflectance);
    const ReadResult result = read_covered({{0.09, 0.02, 0.17, 0.042}, reflectance});
    REQUIRE(result.tags.size() == 1);
    CHECK(to_string(result.tags[0].digits) == kCode);
  }
}

TEST_CASE("what hides most of the bars' height is never taken for bars") {
  for (const double reflectance : {0.05, 0.3, 0.5, 0.9}) {
    for (const double height : {0.06, 0.075, 0.09, 0.12}) {
      CAPTURE(reflectance);
      CAPTURE(height);
      const ReadResult result = read_covered({{0.09, 0.025, 0.1, height}, reflectance});
      const bool wrong = std::ranges::any_of(
          result.tags, [](const Reading& tag) { return to_string(tag.digits) != kCode; });
      CHECK_FALSE(wrong);
    }
  }
}
