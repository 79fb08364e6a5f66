// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_rig.hpp"

#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/geometry/angle.hpp"
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

TEST_CASE("a mounting takes the place of whatever said it, and loads as it was") {
  const test::TemporaryFolder folder;
  const CalibratedMounting mounted{
      {radians(52.125), radians(-1.5), radians(0.25)}, {0.4, -0.25, 0.1}, 0.0004, radians(0.012)};
  for (const std::string camera :
       {"{ image_size: [1280, 960], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6], alpha: 35, side: "
        "left, sigma: 0 }  # front\n",
        "{ image_size: [8, 6], fx: 9, fy: 9, cx: 4, cy: 3, yaw: 10, roll: 3, position: [1, 2, 3], "
        "sigma: { angle: 2 } }  # front\n",
        "{ image_size: [8, 6], fx: 9, fy: 9, cx: 4, cy: 3, yaw: 10 }  # front\n"}) {
    CAPTURE(camera);
    const auto text = rig_with_mounting(
        "rig: r\ncameras:\n  left: " + camera + "vehicle: { height: 0.3 }\n", "left", mounted);
    REQUIRE_MESSAGE(text.has_value(), text.error().message);
    CHECK(text->find("# front") != std::string::npos);
    const std::filesystem::path file = folder.path() / "rig.yaml";
    REQUIRE(write_file(file, *text));
    const auto rig = load_rig(file);
    REQUIRE_MESSAGE(rig.has_value(), rig.error().message);
    const RigCamera& loaded = rig->cameras[0];
    const MountingAngles angles = mounting_angles(loaded.vehicle_from_camera);
    CHECK(degrees(angles.yaw) == doctest::Approx(52.125));
    CHECK(degrees(angles.pitch) == doctest::Approx(-1.5));
    CHECK(degrees(angles.roll) == doctest::Approx(0.25));
    CHECK((loaded.vehicle_from_camera.translation - mounted.position).norm() < 1e-9);
    CHECK(loaded.calibration_sigma.position == doctest::Approx(0.0004));
    CHECK(degrees(loaded.calibration_sigma.angle) == doctest::Approx(0.012));
  }
}

TEST_CASE("what rounds to nothing is written without a sign") {
  const CalibratedMounting mounted{
      {radians(1), radians(-0.0004), radians(0.0004)}, {0.4, -0.00004, -0.00006}, 0, radians(1)};
  const auto text = rig_with_mounting("cameras:\n  left: { fx: 9 }\n", "left", mounted);
  REQUIRE_MESSAGE(text.has_value(), text.error().message);
  CHECK(text->find("position: [0.4000, 0.0000, -0.0001]") != std::string::npos);
  CHECK(text->find("pitch: 0.000,") != std::string::npos);
  CHECK(text->find("roll: 0.000,") != std::string::npos);
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
