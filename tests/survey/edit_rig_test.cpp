// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_rig.hpp"

#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tagsmith/survey/write_calibration.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;

namespace {

const CalibratedIntrinsics kCalibrated{"left.yaml", 0.000234, 0.156};

std::string edited(const std::string& camera) {
  const auto text = rig_with_calibration("cameras:\n  left: " + camera, "left", kCalibrated);
  REQUIRE_MESSAGE(text.has_value(), text.error().message);
  return text->substr(std::string("cameras:\n  left: ").size());
}

}  // namespace

TEST_CASE("a calibration takes the place of whatever said the lens") {
  const std::string with = "{ sigma: { focal: 0.00023, center: 0.16 }, calibration: left.yaml, ";
  CHECK(edited("{ image_size: [1280, 960], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6], alpha: 35, "
               "side: left }  # front\n") ==
        with + "image_size: [1280, 960], alpha: 35, side: left }  # front\n");
  CHECK(edited("{ image_size: [8, 6], fx: 9, fy: 9, cx: 4, cy: 3, distortion: [0, 0, 0, 0, 0], "
               "model: perspective, yaw: 0 }\n") == with + "image_size: [8, 6], yaw: 0 }\n");
  CHECK(edited("{ yaw: 0, calibration: { file: chain.yaml, camera: cam1 } }\n") ==
        with + "yaw: 0 }\n");
}

TEST_CASE("sigma keeps what was not calibrated") {
  CHECK(
      edited("{ yaw: 0, calibration: \"a b.yaml\", sigma: { position: 0.002, focal: 0.01 } }\n") ==
      "{ calibration: left.yaml, yaw: 0, sigma: { center: 0.16, position: 0.002, focal: 0.00023 } "
      "}\n");
  CHECK(edited("{ yaw: 0, fx: 1, sigma: 0 }\n") ==
        "{ sigma: { position: 0, angle: 0, edge: 0, focal: 0.00023, center: 0.16 }, calibration: "
        "left.yaml, yaw: 0 }\n");
}

TEST_CASE("a rig in lines keeps its lines and comments, and loads") {
  const test::TemporaryFolder folder;
  const std::string rig =
      "rig: r   # of the loader\n"
      "cameras:\n"
      "  # bought in May\n"
      "  left:\n"
      "    image_size: [1280, 960]\n"
      "    focal_length_mm: 6.0   # data sheet\n"
      "    sensor_mm: [4.8, 3.6]\n"
      "    # looks to the wall\n"
      "    alpha: 35\n"
      "    side: left\n"
      "    sigma:\n"
      "      position: 0.002   # taped\n"
      "vehicle: { height: 0.24 }\n";
  const auto text = rig_with_calibration(rig, "left", kCalibrated);
  REQUIRE_MESSAGE(text.has_value(), text.error().message);
  CHECK(*text ==
        "rig: r   # of the loader\n"
        "cameras:\n"
        "  # bought in May\n"
        "  left:\n"
        "    calibration: left.yaml\n"
        "    image_size: [1280, 960]\n"
        "    # looks to the wall\n"
        "    alpha: 35\n"
        "    side: left\n"
        "    sigma:\n"
        "      center: 0.16\n"
        "      focal: 0.00023\n"
        "      position: 0.002   # taped\n"
        "vehicle: { height: 0.24 }\n");
  const Camera camera{1280, 960, 1000, 1000, 640, 480, {-0.1}};
  REQUIRE(write_file(folder.path() / "left.yaml",
                     calibration_text(CalibrationFormat::opencv, camera, {}).value()));
  REQUIRE(write_file(folder.path() / "rig.yaml", *text));
  const Result<Rig> loaded = load_rig(folder.path() / "rig.yaml");
  REQUIRE_MESSAGE(loaded.has_value(), loaded.error().message);
  CHECK(loaded->cameras[0].camera.fx == 1000);
  CHECK(loaded->cameras[0].calibration_sigma.focal == 0.00023);
  CHECK(loaded->cameras[0].calibration_sigma.center == 0.16);
  CHECK(loaded->cameras[0].calibration_sigma.position == 0.002);
}

TEST_CASE("file names of any letters are quoted") {
  CHECK(calibration_value({"out/left.yaml", 0, 0}) == "out/left.yaml");
  CHECK(calibration_value({"my \"left\" \\ camera.yaml", 0, 0}) ==
        R"("my \"left\" \\ camera.yaml")");
  CHECK(calibration_value({"12", 0, 0}) == "\"12\"");
}

TEST_CASE("a camera that is not there is refused with those that are") {
  const auto refused = rig_with_calibration("cameras: { left: { yaw: 0 }, rear: { yaw: 1 } }\n",
                                            "front", kCalibrated);
  REQUIRE_FALSE(refused.has_value());
  CHECK(refused.error().message.find("`front`") != std::string::npos);
  CHECK(refused.error().message.find("rear") != std::string::npos);
  CHECK_FALSE(rig_with_calibration("cameras: [", "left", kCalibrated).has_value());
  CHECK_FALSE(rig_with_calibration("rig: r\n", "left", kCalibrated).has_value());
}
