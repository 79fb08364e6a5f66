// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/assumptions.hpp"

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using doctest::Approx;

namespace {

// A rig whose one camera has these intrinsics and, with `sigma`, that key.
Diagnosed<Rig> rig_reading(const std::string& intrinsics, const std::string& sigma) {
  return read_rig_text("rig.yaml", "rig: trial\ncameras:\n  eye: { " + intrinsics + ", yaw: 5" +
                                       (sigma.empty() ? "" : ", sigma: " + sigma) +
                                       " }\nvehicle: { height: 1 }\n");
}

RigCamera camera_of(const std::string& intrinsics, const std::string& sigma = "") {
  const Diagnosed<Rig> reading = rig_reading(intrinsics, sigma);
  REQUIRE_MESSAGE(reading.value.has_value(), to_string(reading.diagnostics));
  return reading.value->cameras.front();
}

const std::string kDataSheet =
    "image_size: [1280, 960], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6]";
const std::string kNumbers = "image_size: [1280, 960], fx: 1600, fy: 1600, cx: 640, cy: 480";

std::string calibration_file() {
  return "calibration: " +
         std::filesystem::absolute("surveys/corridor/calibration-left.yaml").string();
}

}  // namespace

TEST_CASE("the lens of a data sheet bends straight lines unless more is known of it") {
  const double corner = std::hypot(4.8, 3.6) / 2 / 6.0;
  const auto radial = [&](const std::string& intrinsics, const char* sigma) {
    return camera_of(intrinsics, sigma).calibration_sigma.radial;
  };
  const double usual = 0.02 / (corner * corner);
  CHECK(radial(kDataSheet, "") == Approx(usual));
  CHECK(radial(kDataSheet, "{ position: 0.001 }") == Approx(usual));
  CHECK(radial(kDataSheet, "{ distortion: 0.01 }") == Approx(usual / 2));
  CHECK(radial(kDataSheet, "{ focal: 0.01 }") == 0);
  CHECK(radial(kDataSheet, "0") == 0);
  CHECK(radial(kNumbers, "") == 0);
  CHECK(radial(kNumbers, "{ distortion: 0.01 }") > 0);
}

TEST_CASE("pixels by the rounded sizes of a data sheet are square, of the mean size") {
  const std::string rounded = replaced(kDataSheet, "[4.8, 3.6]", "[6.17, 4.55]");
  const double fx = 6.0 * 1280 / 6.17, fy = 6.0 * 960 / 4.55;
  for (const char* sigma :
       {"", "{ position: 0.001, angle: 0.1, focal: 0.01, center: 5, edge: 0 }"}) {
    const RigCamera camera = camera_of(rounded, sigma);
    CHECK(camera.camera.fx == Approx(std::sqrt(fx * fy)));
    CHECK(camera.camera.fy == camera.camera.fx);
  }
  const RigCamera exact = camera_of(rounded, "0");
  CHECK(exact.camera.fx == Approx(fx));
  CHECK(exact.camera.fy == Approx(fy));
  const RigCamera cut = camera_of(replaced(kDataSheet, "[4.8, 3.6]", "[4.8, 3.5]"));
  CHECK(cut.camera.fy > 1.02 * cut.camera.fx);
}

TEST_CASE("a survey that states no sigma is taken to be good to 3 mm and 0.3 degrees") {
  const Survey unstated = survey_of(replaced(right_survey(), "  sigma: 0.003\n", ""));
  CHECK(unstated.sigma == 0.003);
  CHECK(unstated.angle_sigma == Approx(radians(0.3)));
  for (const PlacedTag& tag : unstated.tags) CHECK(tag.sigma == 0.003);
  CHECK(assumptions({&unstated, 1}, Rig{}) ==
        std::vector<std::string>{"survey trial states no sigma: 3 mm assumed",
                                 "survey trial states no angle_sigma: 0.3 degrees assumed"});
}

TEST_CASE("zero in a survey means exact, and is no assumption") {
  const Survey exact =
      survey_of(replaced(right_survey(), "sigma: 0.003", "sigma: 0\n  angle_sigma: 0"));
  CHECK(exact.sigma == 0);
  CHECK(exact.angle_sigma == 0);
  for (const PlacedTag& tag : exact.tags) CHECK(tag.sigma == 0);
  CHECK(assumptions({&exact, 1}, Rig{}).empty());
}

TEST_CASE("a survey whose coordinates are exact has exact attitudes unless it states them") {
  const Survey exact = survey_of(replaced(right_survey(), "sigma: 0.003", "sigma: 0"));
  CHECK(exact.angle_sigma == 0);
  CHECK(assumptions({&exact, 1}, Rig{}).empty());
  const Survey tilted =
      survey_of(replaced(right_survey(), "sigma: 0.003", "sigma: 0\n  angle_sigma: 0.2"));
  CHECK(tilted.angle_sigma == Approx(radians(0.2)));
}

TEST_CASE("tags that state their own sigma need none of the survey") {
  std::string text = replaced(right_survey(), "  sigma: 0.003\n", "");
  text = replaced(text, "  height: 1.4\n  spacing: 0.6\n  first: 1.0\n  pairs: 4\n", "");
  text = replaced(text, "p: [12.0, 22.4, 1.4]", "p: [12.0, 22.4, 1.4], sigma: 0.001");
  CHECK(assumed_sigma(survey_of(text)).has_value());  // of 004L
  text = replaced(text, "p: [8.0, 25.0, 1.4]", "p: [8.0, 25.0, 1.4], sigma: 0.002");
  CHECK_FALSE(assumed_sigma(survey_of(text)).has_value());
}

TEST_CASE("what is assumed is no part of the survey: revision and tolerance stay") {
  const std::string unstated = replaced(right_survey(), "  sigma: 0.003\n", "");
  const Survey exact = survey_of(replaced(right_survey(), "sigma: 0.003", "sigma: 0"));
  CHECK(survey_revision(survey_of(unstated)) == survey_revision(exact));
  CHECK(usual_tolerance(survey_of(unstated)) == usual_tolerance(exact));
  CHECK(usual_tolerance(survey_of(right_survey())) == 0.006);
}

TEST_CASE("a camera without sigma is as uncertain as the source of its intrinsics") {
  struct Row {
    std::string intrinsics;
    double focal;
    double center;
    std::string assumed;
  };
  for (const Row& row :
       {Row{kDataSheet, 0.02, 12.8,
            "edge 0.1 pixels, position 5 mm, angle 0.5 degrees, focal 2 %, center 12.8 pixels, "
            "distortion 2 % at the image's corners (by data sheet)"},
        Row{kNumbers, 0.002, 2,
            "edge 0.1 pixels, position 5 mm, angle 0.5 degrees, focal 0.2 %, center 2 pixels (by "
            "fx, fy, cx, cy)"},
        Row{calibration_file(), 0.001, 1,
            "edge 0.1 pixels, position 5 mm, angle 0.5 degrees, focal 0.1 %, center 1 pixels (by "
            "calibration file)"}}) {
    CAPTURE(row.intrinsics);
    const RigCamera camera = camera_of(row.intrinsics);
    CHECK(camera.calibration_sigma.position == 0.005);
    CHECK(camera.calibration_sigma.angle == Approx(radians(0.5)));
    CHECK(camera.calibration_sigma.focal == row.focal);
    CHECK(camera.calibration_sigma.center == Approx(row.center));
    CHECK(camera.calibration_sigma.edge == 0.1);
    CHECK(camera.assumed_sigma == row.assumed);
  }
}

TEST_CASE("of a camera's sigma what is left out is as usual, and zero is exact") {
  const RigCamera partial = camera_of(kNumbers, "{ position: 0, focal: 0.001 }");
  CHECK(partial.calibration_sigma.position == 0);
  CHECK(partial.calibration_sigma.focal == 0.001);
  CHECK(partial.calibration_sigma.angle == Approx(radians(0.5)));
  CHECK(partial.calibration_sigma.center == 2);
  CHECK(partial.assumed_sigma ==
        "edge 0.1 pixels, angle 0.5 degrees, center 2 pixels (by fx, fy, cx, cy)");
  const RigCamera mounting = camera_of(kNumbers, "{ focal: 0.001, center: 1 }");
  CHECK(mounting.assumed_sigma == "edge 0.1 pixels, position 5 mm, angle 0.5 degrees");
  for (const char* exact :
       {"0", "0.0", "{ position: 0, angle: 0, focal: 0, center: 0, edge: 0 }"}) {
    CAPTURE(exact);
    const RigCamera camera = camera_of(kDataSheet, exact);
    const CalibrationSigma& sigma = camera.calibration_sigma;
    CHECK(sigma.position + sigma.angle + sigma.focal + sigma.center + sigma.edge == 0);
    CHECK(camera.assumed_sigma.empty());
  }
  for (const char* wrong : {"0.5", "exact", "\"0\""}) {
    CAPTURE(wrong);
    const Diagnosed<Rig> reading = rig_reading(kDataSheet, wrong);
    CHECK_FALSE(reading.value.has_value());
    CHECK(count_findings(reading.diagnostics, "wrong-type", 3) == 1);
  }
}

TEST_CASE("cameras of which the same is assumed are named together") {
  Rig rig;
  rig.name = "trial";
  for (const auto& [name, assumed] : {std::pair{"left", "angle 0.5 degrees"},
                                      {"front", ""},
                                      {"right", "angle 0.5 degrees"},
                                      {"rear", "position 5 mm"}}) {
    RigCamera camera;
    camera.name = name;
    camera.assumed_sigma = assumed;
    rig.cameras.push_back(camera);
  }
  CHECK(assumed_calibration(rig) ==
        std::vector<std::string>{
            "rig trial does not state the whole sigma of camera left, right: angle 0.5 degrees "
            "assumed",
            "rig trial does not state the whole sigma of camera rear: position 5 mm assumed"});
}
