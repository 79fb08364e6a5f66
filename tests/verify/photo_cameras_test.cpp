// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/photo_cameras.hpp"

#include <doctest/doctest.h>

#include "tagsmith/survey/read_survey.hpp"

namespace tagsmith::detail {
namespace {

Rig rig_with(const std::vector<std::string>& names) {
  Rig rig;
  rig.name = "test";
  for (const std::string& name : names) {
    rig.cameras.emplace_back();
    rig.cameras.back().name = name;
  }
  return rig;
}

}  // namespace

TEST_CASE("a camera's name in a file's name tells who took it, the rest what was taken together") {
  const PhotoCameras cameras = PhotoCameras::by_names(rig_with({"left", "right", "front left"}));
  const auto left = cameras.origin_of("a/site_04_left.jpg");
  const auto right = cameras.origin_of("a/Site_04_RIGHT.jpg");
  REQUIRE(left);
  REQUIRE(right);
  CHECK(left->camera == 0);
  CHECK(right->camera == 1);
  CHECK(left->station == right->station);
  CHECK(cameras.origin_of("a/site_05_left.jpg")->station != left->station);
  CHECK(cameras.origin_of("b/site_04_left.jpg")->station != left->station);
  CHECK(cameras.origin_of("a/4 front left.jpg")->camera == 2);  // the longer name
  CHECK_FALSE(cameras.origin_of("a/leftover_04.jpg"));
  for (const char* both : {"a/right-wall_06_left.jpg", "a/left-wall_06_right.jpg"}) {
    const auto origin = cameras.origin_of(both);
    REQUIRE_FALSE(origin);
    CHECK(origin.error().message.find("the names of the cameras") != std::string::npos);
  }
  CHECK_FALSE(PhotoCameras::by_names(rig_with({"left", "Left"})).origin_of("a/4_left.jpg"));
  CHECK_FALSE(cameras.origin_of("a/IMG_2041.jpg"));
}

TEST_CASE("a rig's only camera, and a camera that is named, took all photos, each by itself") {
  const PhotoCameras only = PhotoCameras::by_names(rig_with({"phone"}));
  REQUIRE(only.origin_of("IMG_2041.jpg"));
  CHECK(only.origin_of("IMG_2041.jpg")->station != only.origin_of("IMG_2042.jpg")->station);
  const Rig two = rig_with({"left", "right"});
  CHECK(PhotoCameras::by_camera(two, "right")->origin_of("x_left.jpg")->camera == 1);
  const auto none = PhotoCameras::by_camera(two, "rihgt");
  REQUIRE_FALSE(none);
  CHECK(none.error().message ==
        "--camera rihgt: the rig test has no such camera, expected left, right");
}

TEST_CASE("a run tells by its rows, however its photos' paths are written") {
  const Rig rig = load_rig("surveys/corridor/rig.yaml").value();
  const Run run = load_run("surveys/corridor/run.csv", rig).value();
  const PhotoCameras cameras = PhotoCameras::by_run(rig, run);
  const auto right = cameras.origin_of("surveys/corridor/../corridor/photos/corridor_03_right.jpg");
  REQUIRE(right);
  CHECK(right->camera == 1);
  CHECK(right->station ==
        cameras.origin_of("surveys/corridor/photos/corridor_03_left.jpg")->station);
  CHECK_FALSE(cameras.origin_of("elsewhere/corridor_03_right.jpg"));
  Run twice = run;
  twice.measurements[4].cameras["left"].image = run.measurements[2].cameras.at("left").image;
  const auto left =
      PhotoCameras::by_run(rig, twice).origin_of("surveys/corridor/photos/corridor_03_left.jpg");
  REQUIRE_FALSE(left);
  CHECK(left.error().message.find("of the run both have it") != std::string::npos);
}

}  // namespace tagsmith::detail
