// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/assumptions.hpp"
#include "tagsmith/survey/rig.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

Diagnosed<Rig> read_text_as_rig(const std::string& text) {
  const TemporaryFolder folder;
  const auto reading = read_rig(write_text(folder.path() / "rig.yaml", text));
  REQUIRE(reading.has_value());
  return *reading;
}

const Breakage kRigErrors[] = {
    {"unknown key of a camera", "alpha: 35", "alfa: 35", "unknown-key", 7},
    {"no mounting", "    alpha: 35\n", "", "missing-key", 3},
    {"alpha without side", "    side: left\n", "", "missing-key", 3},
    {"alpha and yaw", "alpha: 35", "alpha: 35\n    yaw: 3", "conflicting-keys", 8},
    {"alpha behind", "alpha: 35", "alpha: 135", "out-of-range", 7},
    {"no intrinsics", "    focal_length_mm: 6.0\n    sensor_mm: [4.8, 3.6]\n", "", "missing-key",
     3},
    {"two kinds of intrinsics", "focal_length_mm: 6.0", "focal_length_mm: 6.0\n    fx: 1600",
     "conflicting-keys", 6},
    {"image of one number", "image_size: [1280, 960]", "image_size: 1280", "wrong-type", 4},
    {"image without pixels", "image_size: [1280, 960]", "image_size: [1280, 0]", "out-of-range", 4},
    {"half a pixel", "image_size: [1280, 960]", "image_size: [1280, 960.5]", "wrong-type", 4},
    {"four distortions", "[0.1, 0, 0, 0, 0]", "[0.1, 0, 0, 0]", "wrong-length", 9},
    {"negative exposure", "exposure: 0.01", "exposure: -1", "out-of-range", 9},
    {"negative readout", "exposure: 0.01", "readout: -1", "out-of-range", 9},
    {"negative delay", "exposure: 0.01", "delay: -1", "out-of-range", 9},
    {"negative blur", "blur_px: 0.5", "blur_px: -1", "out-of-range", 9},
    {"focus without aperture", ", aperture_mm: 2", "", "missing-key", 9},
    {"aperture without focus", "focus: 3, ", "", "missing-key", 9},
    {"aperture of nothing", "aperture_mm: 2", "aperture_mm: 0", "out-of-range", 9},
    {"a wall that is none", "wall: left", "wall: roof", "bad-choice", 11},
    {"range upside down", "max: 5.0", "max: 0.1", "out-of-range", 11},
    {"no sigma", ", sigma: 0.01", "", "missing-key", 11},
    {"camera named as a column", "  left:", "  truth_x:", "bad-name", 3},
    {"camera with a blank", "  left:", "  my camera:", "bad-name", 3},
    {"range named as a camera", "  d:", "  left:", "duplicate-key", 10},
    {"a camera twice", "  front:", "  left:", "duplicate-key", 9},
    {"no vehicle height", "height: 0.24, ", "", "missing-key", 12},
    {"envelope without speed", ", speed: 1.5", "", "missing-key", 12},
    {"envelope of negative pitch", "pitch: 2 }", "pitch: -2 }", "out-of-range", 12},
    {"height without a doubt", "roll_sigma: 2", "roll_sigma: 2, height_sigma: 0", "out-of-range",
     12},
    {"focal length off by half", "blur_px: 0.5", "blur_px: 0.5, sigma: { focal: 0.5 }",
     "out-of-range", 9},
    {"unknown part of a calibration", "blur_px: 0.5", "blur_px: 0.5, sigma: { roll: 0.5 }",
     "unknown-key", 9},
    {"calibration and data sheet", "focal_length_mm: 6.0",
     "focal_length_mm: 6.0\n    calibration: none.yaml", "conflicting-keys", 6},
    {"attitude of nothing", "roll_sigma: 2", "roll_sigma: 0", "out-of-range", 12},
};

}  // namespace

TEST_CASE("the rig that the others break is right, and says what it says") {
  const Diagnosed<Rig> reading = read_text_as_rig(right_rig());
  CHECK_MESSAGE(reading.diagnostics.empty(), to_string(reading.diagnostics));
  REQUIRE(reading.value.has_value());
  const Rig& rig = *reading.value;
  REQUIRE(rig.cameras.size() == 2);
  CHECK(rig.cameras[0].camera.fx == doctest::Approx(1600));
  CHECK(rig.cameras[0].side == Side::left);
  CHECK(rig.cameras[1].camera.fy == 1601);
  CHECK(rig.cameras[1].camera.distortion[0] == 0.1);
  CHECK_FALSE(rig.cameras[1].side.has_value());
  CHECK(rig.cameras[1].vehicle_from_camera.translation == Eigen::Vector3d(0.5, 0, 0.1));
  CHECK(rig.cameras[1].exposure == 0.01);
  CHECK(rig.cameras[1].blur_px == 0.5);
  CHECK(rig.cameras[1].focus == 3.0);
  CHECK(rig.cameras[1].aperture == 0.002);
  CHECK_FALSE(rig.cameras[0].focus.has_value());
  REQUIRE(rig.ranges.size() == 1);
  CHECK(rig.ranges[0].sigma == 0.01);
  CHECK(rig.roll_sigma == doctest::Approx(radians(2)));
  REQUIRE(rig.envelope.has_value());
  CHECK(rig.envelope->yaw == doctest::Approx(radians(8)));
  CHECK(rig.envelope->pitch == doctest::Approx(radians(2)));
  CHECK(rig.envelope->roll == 0);
}

TEST_CASE("a rig that is only odd is warned about and kept") {
  const Breakage warnings[] = {
      {"alpha in radians", "alpha: 35", "alpha: 0.61", "angle-unit", 7},
      {"sides exchanged", "side: left", "side: right", "camera-side", 8},
      {"side behind the camera", "yaw: 5,", "yaw: -5, side: left,", "camera-side", 9},
      {"through the vehicle", "yaw: 5, pitch: -2, position: [0.5, 0, 0.1]",
       "yaw: -50, position: [0.5, 0.8, 0.1]", "looks-across", 9},
      {"milliseconds", "exposure: 0.01", "exposure: 2", "long-exposure", 9},
      {"a resolution", "max: 5.0, sigma: 0.01", "max: 5.0, sigma: 0.001", "fine-range", 11},
  };
  for (const Breakage& odd : warnings) {
    CAPTURE(odd.name);
    const Diagnosed<Rig> reading = read_text_as_rig(replaced(right_rig(), odd.from, odd.to));
    CHECK_MESSAGE(reading.value.has_value(), to_string(reading.diagnostics));
    CHECK_MESSAGE(count_findings(reading.diagnostics, odd.code, odd.line) == 1,
                  to_string(reading.diagnostics));
    CHECK(reading.diagnostics.size() == 1);
  }
  // Ahead, and slightly inwards.
  const std::string mild = "yaw: -5, pitch: -2, position: [0.5, 0.8, 0.1]";
  CHECK(read_text_as_rig(replaced(right_rig(), "yaw: 5, pitch: -2, position: [0.5, 0, 0.1]", mild))
            .diagnostics.empty());
}

TEST_CASE(
    "standard deviations of height and calibration are what the rig says, or their defaults") {
  const std::string stated = replaced(
      replaced(right_rig(), "roll_sigma: 2", "roll_sigma: 2, height_sigma: 0.02"), "blur_px: 0.5",
      "blur_px: 0.5, sigma: { position: 0.001, angle: 0.05, focal: 0.002, center: 0.5 }");
  const Diagnosed<Rig> reading = read_text_as_rig(stated);
  REQUIRE_MESSAGE(reading.value.has_value(), to_string(reading.diagnostics));
  const CalibrationSigma& sigma = reading.value->cameras[1].calibration_sigma;
  CHECK(reading.value->height_sigma == 0.02);
  CHECK(sigma.position == 0.001);
  CHECK(sigma.angle == doctest::Approx(radians(0.05)));
  CHECK(sigma.focal == 0.002);
  CHECK(sigma.center == 0.5);
  CHECK(read_text_as_rig(right_rig()).value->height_sigma == 0.05);
}

TEST_CASE("a rolling shutter counts by the vehicle's speed, or by a usual one") {
  const std::string text =
      "rig: trial\ncameras:\n  left: { image_size: [1280, 960], focal_length_mm: 6.0, sensor_mm: "
      "[4.8, 3.6], alpha: 35, side: left, readout: 0.02, sigma: 0 }\nvehicle: { height: 1.1";
  const auto usual = read_text_as_rig(text + " }\n");
  REQUIRE(usual.value);
  CHECK(usual.value->cameras[0].calibration_sigma.shutter == doctest::Approx(0.04));
  CHECK(assumptions({}, *usual.value) ==
        std::vector<std::string>{"rig trial has a readout and states no speed (vehicle.envelope): "
                                 "2 m/s assumed"});
  CHECK(usual_speed(*usual.value) == 2);
  for (const double speed : {0.0, 0.5}) CHECK(assumptions({}, *usual.value, speed).empty());
  const auto stated = read_text_as_rig(text + ", envelope: { lateral: 0.3, yaw: 5, speed: 1 } }\n");
  REQUIRE(stated.value);
  CHECK(stated.value->cameras[0].calibration_sigma.shutter == doctest::Approx(0.02));
}

TEST_CASE("a camera without a readout is assumed to have a global shutter, unless it stands") {
  const std::string camera =
      "rig: trial\ncameras:\n  left: { image_size: [1280, 960], focal_length_mm: 6.0, sensor_mm: "
      "[4.8, 3.6], alpha: 35, side: left, sigma: ";
  const std::vector<std::string> assumed{
      "rig trial states no readout of camera left: a global shutter assumed"};
  const auto sentences = [&](const std::string& sigma, const std::string& rest) {
    const auto reading =
        read_text_as_rig(camera + sigma + " }\nvehicle: { height: 1.1" + rest + " }\n");
    REQUIRE(reading.value);
    return assumptions({}, *reading.value);
  };
  const std::string known = "{ position: 0.001, angle: 0.05, focal: 0.002, center: 1, edge: 0.1 }";
  CHECK(sentences(known, "") == assumed);
  CHECK(sentences(known, ", envelope: { lateral: 0.3, yaw: 5, speed: 1 }") == assumed);
  CHECK(sentences(known, ", envelope: { lateral: 0.3, yaw: 5, speed: 0 }").empty());
  CHECK(sentences("0", "").empty());  // pictures that were computed
  const auto reading = read_text_as_rig(
      camera + known +
      " }\nvehicle: { height: 1.1, envelope: { lateral: 0.3, yaw: 5, speed: 1 } }\n");
  REQUIRE(reading.value);
  CHECK(assumptions({}, *reading.value, 0).empty());
  CHECK(assumptions({}, *reading.value, 2) == assumed);
}

TEST_CASE("photos of one row are assumed to be of one moment, unless the rig says otherwise") {
  const auto reading_of = [](const std::string& left, const std::string& right) {
    const std::string camera =
        "{ image_size: [1280, 960], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6], alpha: 35, sigma: "
        "{ position: 0.001, angle: 0.05, focal: 0.002, center: 1, edge: 0.1 }, side: ";
    return read_text_as_rig("rig: trial\ncameras:\n  left: " + camera + "left" + left +
                            " }\n  right: " + camera + "right" + right +
                            " }\nvehicle: { height: 1.1 }\n");
  };
  const auto sentences = [&](const std::string& left, const std::string& right) {
    const auto reading = reading_of(left, right);
    REQUIRE(reading.value);
    return assumptions({}, *reading.value);
  };
  using Sentences = std::vector<std::string>;
  CHECK(
      sentences("", "") ==
      Sentences{"rig trial states no readout and no delay of camera left, right: global shutters, "
                "triggered together, assumed"});
  CHECK(sentences(", readout: 0", ", readout: 0") ==
        Sentences{"rig trial states no delay of camera left, right: photos of one moment assumed"});
  CHECK(sentences(", readout: 0, delay: 0", ", delay: 0") ==
        Sentences{"rig trial states no readout of camera right: a global shutter assumed"});
  CHECK(sentences(", readout: 0, delay: 0", ", readout: 0, delay: 0").empty());
  CHECK(sentences(", readout: 0, delay: 0", ", readout: 0, delay: 0.01") ==
        Sentences{"rig trial has a delay and states no speed (vehicle.envelope): 2 m/s assumed"});
  const auto late = reading_of("", ", delay: 0.01");
  REQUIRE(late.value);
  CHECK(late.value->cameras[0].calibration_sigma.delay == 0);
  CHECK(late.value->cameras[1].calibration_sigma.delay == doctest::Approx(0.02));
}

TEST_CASE("every way to break a rig is reported by its rule and line") {
  for (const Breakage& broken : kRigErrors) {
    CAPTURE(broken.name);
    const Diagnosed<Rig> reading = read_text_as_rig(replaced(right_rig(), broken.from, broken.to));
    CHECK_FALSE(reading.value.has_value());
    CHECK_MESSAGE(count_findings(reading.diagnostics, broken.code, broken.line) >= 1,
                  to_string(reading.diagnostics));
  }
}

TEST_CASE("odd cameras are warned about") {
  const auto swapped = read_text_as_rig(replaced(right_rig(), "[4.8, 3.6]", "[3.6, 4.8]"));
  CHECK(swapped.value.has_value());
  CHECK(count_findings(swapped.diagnostics, "odd-pixels", 6) == 1);
  const auto outside = read_text_as_rig(replaced(right_rig(), "cx: 640", "cx: 1640"));
  CHECK(outside.value.has_value());
  CHECK(count_findings(outside.diagnostics, "odd-principal-point", 9) == 1);
}

TEST_CASE("a side camera looks forward and to its side, level and upright") {
  for (const Side side : {Side::left, Side::right}) {
    const Pose vehicle_from_camera = vehicle_from_side_camera(side, radians(35));
    const Eigen::Vector3d axis = vehicle_from_camera.rotation.col(2);
    const double to_left = side == Side::left ? 1.0 : -1.0;
    CHECK(axis.x() == doctest::Approx(std::sin(radians(35))));
    CHECK(axis.y() == doctest::Approx(to_left * std::cos(radians(35))));
    CHECK(std::abs(axis.z()) < 1e-15);
    CHECK((vehicle_from_camera.rotation.col(1) + Eigen::Vector3d::UnitZ()).norm() < 1e-15);
  }
}

TEST_CASE("yaw 55 to the left is alpha 35 on the left") {
  const Pose by_yaw = vehicle_from_camera(radians(55), 0, 0, Eigen::Vector3d::Zero());
  const Pose by_alpha = vehicle_from_side_camera(Side::left, radians(35));
  CHECK((by_yaw.rotation - by_alpha.rotation).norm() < 1e-12);
}

TEST_CASE("a vehicle's forward is its heading, its left to the left of it") {
  const Pose pose = world_from_vehicle({1, 2, 3}, radians(90));  // towards +x
  CHECK((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(2, 2, 3)).norm() < 1e-12);
  CHECK((pose * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(1, 3, 3)).norm() < 1e-12);
  CHECK(pose.rotation.determinant() == doctest::Approx(1.0));
}
