// SPDX-License-Identifier: Apache-2.0
// Reading tags where they are expected.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <doctest/doctest.h>

#include "decoder/image/load.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reader.hpp"
#include "decoder/simulate/survey_view.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tests/support/seen_tag.hpp"

using namespace tagsmith::detail;
using tagsmith::detail::test::farthest_apart;

namespace {

GrayImage photo() {
  return load_gray_image("surveys/corridor/photos/corridor_01_left.jpg").value();
}

// Where the search finds the photo's tag, every corner moved by the same few pixels.
ExpectedTag moved(const Reading& reading, double dx, double dy, double uncertainty_px) {
  ExpectedTag expected{reading.corners, uncertainty_px};
  for (PixelPoint& corner : expected.corners) corner = corner + PixelPoint{dx, dy};
  return expected;
}

}  // namespace

TEST_CASE("an expected tag is read without a search although it is some pixels off") {
  const GrayImage image = photo();
  const ReadResult searched = read_tags(image.view());
  REQUIRE(searched.tags.size() == 1);
  CHECK(searched.tags.front().proposer == "near bars");
  for (const double off : {0.0, 3.0, 8.0, 20.0, 40.0}) {
    CAPTURE(off);
    ReadOptions options;
    options.search = Search::never;
    options.expected = {moved(searched.tags.front(), 0.7 * off, -0.7 * off, off + 1)};
    const ReadResult result = read_tags(image.view(), options);
    REQUIRE(result.tags.size() == 1);
    CHECK(result.tags.front().proposer == "expected");
    CHECK(result.tags.front().digits == searched.tags.front().digits);
    CHECK(farthest_apart(result.tags.front().corners, searched.tags.front().corners) < 0.05);
  }
}

TEST_CASE("where an expected tag is not, the picture is searched as the caller says") {
  const GrayImage image = photo();
  const ReadResult searched = read_tags(image.view());
  REQUIRE(searched.tags.size() == 1);
  ReadOptions options;
  options.expected = {moved(searched.tags.front(), -400, 100, 5)};
  options.search = Search::never;
  CHECK(read_tags(image.view(), options).tags.empty());
  options.search = Search::when_missing;
  CHECK(read_tags(image.view(), options).tags.size() == 1);
  options.expected = {moved(searched.tags.front(), 1, 1, 5)};
  options.search = Search::always;
  CHECK(read_tags(image.view(), options).tags.size() == 1);
}

TEST_CASE("expectations out of the picture, of no size or turned inside out are harmless") {
  const GrayImage image = photo();
  ReadOptions options;
  options.search = Search::never;
  const auto expect = [&](FrameCorners corners, double uncertainty_px) {
    options.expected = {{corners, uncertainty_px}};
    CHECK(read_tags(image.view(), options).tags.empty());
  };
  expect({PixelPoint{-500, -500}, {-400, -500}, {-400, -450}, {-500, -450}}, 3);
  expect({PixelPoint{5000, 5000}, {5100, 5000}, {5100, 5050}, {5000, 5050}}, 3);
  expect({PixelPoint{300, 300}, {300, 300}, {300, 300}, {300, 300}}, 3);
  expect({PixelPoint{100, 100}, {100, 150}, {200, 150}, {200, 100}}, 3);
  expect({PixelPoint{1279, 959}, {1290, 959}, {1290, 965}, {1279, 965}}, 0);
  const double nan = std::nan("");
  expect({PixelPoint{nan, 0}, {nan, 0}, {nan, nan}, {0, nan}}, 3);
  expect({PixelPoint{100, 100}, {200, 100}, {200, 150}, {100, 150}}, nan);
}

TEST_CASE("a survey and the camera's pose tell where the tags are") {
  const auto survey = load_survey("surveys/corridor/survey.yaml");
  const auto rig = load_rig("surveys/corridor/rig.yaml");
  REQUIRE(survey.has_value());
  REQUIRE(rig.has_value());
  const Pose world_from_vehicle = vehicle_in_tunnel(*survey, {0.9, 2.0, 0.24}, std::nullopt);
  for (const RigCamera& camera : rig->cameras) {
    const SurveyView view = render_survey_view(*survey, camera, world_from_vehicle, {}, 5);
    const Pose world_from_camera = world_from_vehicle * camera.vehicle_from_camera;
    ReadOptions options = read_options_for(std::span(&*survey, 1));
    options.expected = expected_tags(*survey, camera.camera, inverse(world_from_camera), 2);
    options.search = Search::never;
    const ReadResult found = read_tags(view.view.image.view(), options);
    CHECK(!found.tags.empty());
    CHECK(found.tags.size() == options.expected.size());
    for (const ExpectedTag& expected : options.expected) {
      const auto matches = [&](const Reading& tag) {
        return farthest_apart(tag.corners, expected.corners) < 0.2;
      };
      CHECK(std::ranges::any_of(found.tags, matches));
    }
  }
}
