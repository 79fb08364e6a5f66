// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/survey/rig.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

// As OpenCV 4.6 writes it (its sample program camera_calibration.cpp, shortened).
const char* const kOpenCvYaml = R"(%YAML:1.0
---
calibration_time: "Tue 01 Mar 2022 10:00:00 AM CET"
nr_of_frames: 25
image_width: 1280
image_height: 960
# flags:  +fix_aspectRatio
flags: 2
fisheye_model: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 8.0050000000000000e+02, 0., 6.4025000000000000e+02, 0.,
       8.0150000000000000e+02, 4.8075000000000000e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.0000000000000001e-01, 5.0000000000000000e-02,
       1.0000000000000000e-03, -2.0000000000000000e-03, 1.0000000000000000e-02 ]
avg_reprojection_error: 2.0000000000000001e-01
grid_points: !!opencv-matrix
   rows: 3
   cols: 1
   dt: "3f"
   data: [ 0., 0., 0., 0., 0., 0., 0., 0., 0. ]
)";

const char* const kOpenCvXml = R"(<?xml version="1.0"?>
<opencv_storage>
<calibration_time>"Tue 01 Mar 2022 10:00:00 AM CET"</calibration_time>
<image_width>1280</image_width>
<image_height>960</image_height>
<!-- flags: fisheye -->
<flags>0</flags>
<fisheye_model>1</fisheye_model>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    8.0050000000000000e+02 0. 6.4025000000000000e+02 0.
    8.0150000000000000e+02 4.8075000000000000e+02 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>4</rows>
  <cols>1</cols>
  <dt>d</dt>
  <data>
    -2.9999999999999999e-02 1.0000000000000000e-02
    -4.0000000000000001e-03 6.9999999999999999e-04</data></distortion_coefficients>
<per_view type_id="opencv-sequence">
  <_>1.</_>
  <_>2.</_></per_view>
</opencv_storage>
)";

// As ROS's camera_calibration_parsers write it.
const char* const kRosYaml = R"(image_width: 1280
image_height: 960
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [800.5, 0, 640.25, 0, 801.5, 480.75, 0, 0, 1]
distortion_model: rational_polynomial
distortion_coefficients:
  rows: 1
  cols: 8
  data: [0.8, 0.1, 0.001, -0.002, 0.01, 0.9, 0.15, 0.02]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [700, 0, 640, 0, 0, 700, 480, 0, 0, 0, 1, 0]
)";

// As `rostopic echo -n 1 camera_info` prints a message.
const char* const kRosMessage = R"(header:
  seq: 17
  stamp:
    secs: 1646125200
    nsecs: 0
  frame_id: "camera"
height: 960
width: 1280
distortion_model: "equidistant"
D: [-0.03, 0.01, -0.004, 0.0007]
K: [800.5, 0.0, 640.25, 0.0, 801.5, 480.75, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
P: [700.0, 0.0, 640.0, 0.0, 0.0, 700.0, 480.0, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
binning_y: 0
roi:
  x_offset: 0
  y_offset: 0
  height: 0
  width: 0
  do_rectify: False
---
)";

const char* const kKalibr = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.2, 0.05, 0.001, -0.002]
  distortion_model: radtan
  intrinsics: [800.5, 801.5, 640.25, 480.75]
  resolution: [1280, 960]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [0.99, 0.01, 0.0, -0.11]
  - [-0.01, 0.99, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0]
  camera_model: pinhole
  distortion_coeffs: [-0.03, 0.01, -0.004, 0.0007]
  distortion_model: equidistant
  intrinsics: [800.5, 801.5, 640.25, 480.75]
  resolution: [1280, 960]
  rostopic: /cam1/image_raw
)";

std::string rig_with(const std::string& keys) {
  return "rig: trial\ncameras:\n  left:\n    " + keys +
         "\n    alpha: 35\n    side: left\nvehicle: { height: 0.24 }\n";
}

// The reading of a rig whose camera has these keys, beside a calibration of the name `file`.
Diagnosed<Rig> read_with(const std::string& file, const std::string& calibration,
                         const std::string& keys) {
  const TemporaryFolder folder;
  write_text(folder.path() / file, calibration);
  const auto reading = read_rig(write_text(folder.path() / "rig.yaml", rig_with(keys)));
  REQUIRE(reading.has_value());
  return *reading;
}

void check_numbers(const Diagnosed<Rig>& reading, LensModel lens,
                   const std::array<double, 8>& distortion) {
  REQUIRE_MESSAGE(reading.value.has_value(), to_string(reading.diagnostics));
  CHECK_MESSAGE(reading.diagnostics.empty(), to_string(reading.diagnostics));
  const Camera& camera = reading.value->cameras[0].camera;
  CHECK(camera.width == 1280);
  CHECK(camera.height == 960);
  CHECK(camera.fx == 800.5);
  CHECK(camera.fy == 801.5);
  CHECK(camera.cx == 640.25);
  CHECK(camera.cy == 480.75);
  CHECK(camera.lens == lens);
  CHECK(camera.distortion == distortion);
}

constexpr std::array<double, 8> kFive{-0.2, 0.05, 0.001, -0.002, 0.01};
constexpr std::array<double, 8> kFour{-0.2, 0.05, 0.001, -0.002};
constexpr std::array<double, 8> kEight{0.8, 0.1, 0.001, -0.002, 0.01, 0.9, 0.15, 0.02};
constexpr std::array<double, 8> kFisheye{-0.03, 0.01, -0.004, 0.0007};

// A right file with one place changed, and the finding that must name the place in that file.
struct BrokenCalibration {
  std::string name;
  const char* text;
  const char* from;
  const char* to;
  const char* code;
  int line;
};

const BrokenCalibration kCalibrationErrors[] = {
    {"YAML cut short", kOpenCvYaml, "0., 0., 1. ]", "0., 0.", "syntax", -1},
    {"XML cut short", kOpenCvXml, "</opencv_storage>", "", "syntax", -1},
    {"another tag", kOpenCvYaml, "camera_matrix: !!opencv-matrix", "camera_matrix: !!python/object",
     "yaml-tag", -1},
    {"no matrix", kOpenCvYaml, "camera_matrix", "camera_matrices", "missing-key", -1},
    {"no distortion", kOpenCvYaml, "distortion_coefficients", "coefficients", "missing-key", -1},
    {"a word for a number", kOpenCvYaml, "8.0150000000000000e+02", "wide", "wrong-type", 15},
    {"not finite", kOpenCvYaml, "8.0150000000000000e+02", ".Nan", "not-finite", 15},
    {"a word in XML", kOpenCvXml, "8.0150000000000000e+02", "wide", "wrong-type", 13},
    {"too few numbers", kOpenCvYaml, "0., 0., 1. ]", "0., 0. ]", "wrong-length", 14},
    {"two rows", kOpenCvYaml, "rows: 3\n   cols: 3", "rows: 2\n   cols: 3", "wrong-length", 14},
    {"rows without end", kOpenCvYaml, "rows: 3\n   cols: 3", "rows: 3\n   cols: 30000000",
     "out-of-range", 12},
    {"skew", kOpenCvYaml, "[ 8.0050000000000000e+02, 0.,", "[ 8.0050000000000000e+02, 5.,",
     "camera-matrix", 10},
    {"no focal length", kOpenCvYaml, "8.0050000000000000e+02", "0.", "out-of-range", 10},
    {"an image without width", kOpenCvYaml, "image_width: 1280", "image_width: 0", "out-of-range",
     5},
    {"width without height", kOpenCvYaml, "image_height: 960\n", "", "missing-key", 5},
    {"a key twice", kOpenCvYaml, "flags: 2", "image_width: 640", "duplicate-key", 8},
    {"three coefficients", kOpenCvYaml, "rows: 5\n   cols: 1\n   dt: d\n   data: [ ",
     "dt: d\n   data: [ 1, ", "wrong-length", 16},
    {"an unknown model", kRosYaml, "rational_polynomial", "double_sphere", "bad-choice", 8},
    {"five of a fisheye", kOpenCvYaml, "fisheye_model: 0", "fisheye_model: 1", "wrong-length", 16},
    {"no calibration yet", kRosMessage, "K: [800.5, 0.0, 640.25, 0.0, 801.5, 480.75",
     "K: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0", "out-of-range", 11},
    {"cropped", kRosMessage, "  height: 0", "  height: 480", "part-of-image", 19},
    {"an omnidirectional lens", kOpenCvYaml, "flags: 2", "xi: 1.2", "lens-model", 8},
    {"binned", kRosMessage, "binning_x: 0", "binning_x: 2", "part-of-image", 14},
    {"a window", kRosMessage, "x_offset: 0", "x_offset: 20", "part-of-image", 17},
    {"several cameras", kKalibr, "rostopic: /cam0", "topic: /cam0", "several-cameras", 1},
    {"nothing of the kind", kKalibr, kKalibr, "- 1\n- 2\n", "unknown-format", -1},
    {"an XML of another kind", kOpenCvXml, kOpenCvXml, "<svg><g/></svg>", "missing-key", -1},
    {"an XML with nothing in it", kOpenCvXml, kOpenCvXml, "<opencv_storage/>", "empty-file", 1},
};

const BrokenCalibration kKalibrErrors[] = {
    {"another projection", kKalibr, "camera_model: pinhole", "camera_model: omni", "bad-choice", 3},
    {"another distortion", kKalibr, "distortion_model: radtan", "distortion_model: fov",
     "bad-choice", 5},
    {"three intrinsics", kKalibr, "[800.5, 801.5, 640.25, 480.75]", "[800.5, 801.5, 640.25]",
     "wrong-length", 6},
    {"no resolution", kKalibr, "  resolution: [1280, 960]\n", "", "missing-key", -1},
    {"two coefficients", kKalibr, "[-0.2, 0.05, 0.001, -0.002]", "[-0.2, 0.05]", "wrong-length", 4},
};

}  // namespace

TEST_CASE("OpenCV, ROS and kalibr calibrations give the camera they describe") {
  check_numbers(read_with("left.yml", kOpenCvYaml, "calibration: left.yml"), LensModel::perspective,
                kFive);
  check_numbers(read_with("left.xml", kOpenCvXml, "calibration: left.xml"), LensModel::fisheye,
                kFisheye);
  check_numbers(read_with("left.yaml", kRosYaml, "calibration: left.yaml"), LensModel::perspective,
                kEight);
  check_numbers(read_with("left.yaml", kRosMessage, "calibration: left.yaml"), LensModel::fisheye,
                kFisheye);
  check_numbers(read_with("c.yaml", kKalibr, "calibration: { file: c.yaml, camera: cam0 }"),
                LensModel::perspective, kFour);
  check_numbers(read_with("c.yaml", kKalibr, "calibration: { file: c.yaml, camera: cam1 }"),
                LensModel::fisheye, kFisheye);
}

TEST_CASE("variants of the formats are read as well") {
  const std::string upper = replaced(replaced(kOpenCvYaml, "camera_matrix", "Camera_Matrix"),
                                     "distortion_coefficients", "Distortion_Coefficients");
  check_numbers(read_with("a.yml", upper, "calibration: a.yml"), LensModel::perspective, kFive);
  const std::string ros2 = replaced(replaced(kRosMessage, "K: [", "k: ["), "D: [", "d: [");
  check_numbers(read_with("a.yml", ros2, "calibration: a.yml"), LensModel::fisheye, kFisheye);
  const std::string rows =
      replaced(kRosMessage, "[800.5, 0.0, 640.25, 0.0, 801.5, 480.75, 0.0, 0.0, 1.0]",
               "[[800.5, 0, 640.25], [0, 801.5, 480.75], [0, 0, 1]]");
  check_numbers(read_with("a.yml", rows, "calibration: a.yml"), LensModel::fisheye, kFisheye);
  const std::string plain =
      replaced(replaced(kKalibr, "distortion_model: radtan", "distortion_model: none"),
               "  distortion_coeffs: [-0.2, 0.05, 0.001, -0.002]\n", "");
  check_numbers(read_with("a.yml", plain, "calibration: { file: a.yml, camera: cam0 }"),
                LensModel::perspective, {});
  const std::string crlf = [] {
    std::string text;
    for (const char c : std::string(kOpenCvYaml)) text += c == '\n' ? "\r\n" : std::string(1, c);
    return text;
  }();
  check_numbers(read_with("a.yml", crlf, "calibration: a.yml"), LensModel::perspective, kFive);
  const std::string fourteen = replaced(replaced(kRosYaml, "cols: 8", "cols: 14"), "0.15, 0.02]",
                                        "0.15, 0.02, 0, 0, 0, 0, 0, 0]");
  check_numbers(read_with("a.yml", fourteen, "calibration: a.yml"), LensModel::perspective, kEight);
}

TEST_CASE("every way to break a calibration is reported by its rule and line, in its file") {
  const auto check = [](const BrokenCalibration& broken, const std::string& keys) {
    CAPTURE(broken.name);
    const Diagnosed<Rig> reading =
        read_with("c.yaml", replaced(broken.text, broken.from, broken.to), keys);
    CHECK_FALSE(reading.value.has_value());
    CHECK_MESSAGE(count_findings(reading.diagnostics, broken.code, broken.line) >= 1,
                  to_string(reading.diagnostics));
    for (const Diagnostic& finding : reading.diagnostics) {
      CHECK_MESSAGE(finding.file.ends_with("c.yaml"), to_string(finding));
    }
  };
  for (const BrokenCalibration& broken : kCalibrationErrors) check(broken, "calibration: c.yaml");
  for (const BrokenCalibration& broken : kKalibrErrors) {
    check(broken, "calibration: { file: c.yaml, camera: cam0 }");
  }
}

TEST_CASE("file and rig must agree on the image size") {
  const auto equal =
      read_with("a.yml", kOpenCvYaml, "calibration: a.yml\n    image_size: [1280, 960]");
  CHECK(equal.value.has_value());
  const auto other =
      read_with("a.yml", kOpenCvYaml, "calibration: a.yml\n    image_size: [640, 480]");
  CHECK_FALSE(other.value.has_value());
  CHECK(count_findings(other.diagnostics, "calibration-size", 5) == 1);
  const std::string unsized_file =
      replaced(replaced(kOpenCvYaml, "image_width: 1280\n", ""), "image_height: 960\n", "");
  check_numbers(read_with("a.yml", unsized_file, "calibration: a.yml\n    image_size: [1280, 960]"),
                LensModel::perspective, kFive);
  const auto neither = read_with("a.yml", unsized_file, "calibration: a.yml");
  CHECK(count_findings(neither.diagnostics, "missing-key", 3) == 1);
}

TEST_CASE("four coefficients without a model are refused, and the rig can say what they are") {
  std::string silent = replaced(kOpenCvXml, "<fisheye_model>1</fisheye_model>", "");
  const auto refused = read_with("a.xml", silent, "calibration: a.xml");
  CHECK_FALSE(refused.value.has_value());
  CHECK(count_findings(refused.diagnostics, "lens-model") == 1);
  check_numbers(read_with("a.xml", silent, "calibration: a.xml\n    model: fisheye"),
                LensModel::fisheye, kFisheye);
  const auto contradiction =
      read_with("a.xml", kOpenCvXml, "calibration: a.xml\n    model: perspective");
  CHECK(count_findings(contradiction.diagnostics, "lens-model", 8) == 1);
}

TEST_CASE("a rig says which file and camera, and what else it says must fit") {
  const auto missing = read_with("a.yml", kOpenCvYaml, "calibration: b.yml");
  CHECK(count_findings(missing.diagnostics, "calibration-file", 4) == 1);
  const auto unknown = read_with("c.yaml", kKalibr, "calibration: { file: c.yaml, camera: cam7 }");
  CHECK(count_findings(unknown.diagnostics, "unknown-camera") == 1);
  const auto single = read_with("a.yml", kOpenCvYaml, "calibration: { file: a.yml, camera: cam0 }");
  CHECK(count_findings(single.diagnostics, "one-camera") == 1);
  const auto both = read_with("a.yml", kOpenCvYaml, "calibration: a.yml\n    fx: 1600");
  CHECK(count_findings(both.diagnostics, "conflicting-keys", 5) == 1);
  const auto list = read_with("a.yml", kOpenCvYaml, "calibration: [a.yml]");
  CHECK(count_findings(list.diagnostics, "wrong-type", 4) == 1);
}

TEST_CASE("odd calibrations are warned about") {
  const auto outside = read_with("a.yml", replaced(kOpenCvYaml, "6.4025000000000000e+02", "6402."),
                                 "calibration: a.yml");
  CHECK(outside.value.has_value());
  CHECK(count_findings(outside.diagnostics, "odd-principal-point", 4) == 1);
  const auto millimetres = read_with("a.yml",
                                     replaced(replaced(kOpenCvYaml, "8.0050000000000000e+02", "6."),
                                              "8.0150000000000000e+02", "6."),
                                     "calibration: a.yml");
  CHECK(count_findings(millimetres.diagnostics, "odd-focal-length", 4) == 1);
  const auto folding = read_with("a.yml", replaced(kOpenCvYaml, "-2.0000000000000001e-01", "-0.6"),
                                 "calibration: a.yml");
  CHECK(folding.value.has_value());
  CHECK(count_findings(folding.diagnostics, "lens-reach", 4) == 1);
}

TEST_CASE("a rig's own numbers may be those of a fisheye or of the rational model") {
  const std::string size = "image_size: [1280, 960]\n    ";
  const std::string numbers =
      size + "fx: 800.5\n    fy: 801.5\n    cx: 640.25\n    cy: 480.75\n    ";
  check_numbers(
      read_with("x", "", numbers + "model: fisheye\n    distortion: [-0.03, 0.01, -0.004, 0.0007]"),
      LensModel::fisheye, kFisheye);
  check_numbers(
      read_with("x", "", numbers + "distortion: [0.8, 0.1, 0.001, -0.002, 0.01, 0.9, 0.15, 0.02]"),
      LensModel::perspective, kEight);
  const auto five = read_with("x", "", numbers + "model: fisheye\n    distortion: [0, 0, 0, 0, 0]");
  CHECK(count_findings(five.diagnostics, "wrong-length", 10) == 1);
  const auto lens = read_with(
      "x", "", size + "focal_length_mm: 1.5\n    sensor_mm: [4.8, 3.6]\n    model: fisheye");
  REQUIRE(lens.value.has_value());
  CHECK(lens.value->cameras[0].camera.lens == LensModel::fisheye);
  const auto unknown = read_with("x", "", numbers + "model: fish");
  CHECK(count_findings(unknown.diagnostics, "bad-choice", 9) == 1);
}

TEST_CASE("hostile calibrations end with a finding, not with a crash") {
  std::string deep = "<opencv_storage>";
  for (int i = 0; i < 200'000; ++i) deep += "<a>";
  const std::string bomb =
      "<!DOCTYPE x [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b "
      "\"&a;&a;&a;&a;\">]><opencv_storage><camera_"
      "matrix>&b;</camera_matrix><distortion_coefficients>&b;</distortion_coefficients></opencv_"
      "storage>";
  std::string closed = deep;
  for (int i = 0; i < 200'000; ++i) closed += "</a>";
  for (const std::string& text :
       {std::string(), std::string("<"), std::string("%YAML:1.0\n---\n"),
        std::string("\xFF\xFE<a/>"), deep, closed + "</opencv_storage>", bomb,
        std::string("camera_matrix: {data: {data: []}}\nD: 1\n"), std::string(9'000'000, ' '),
        "camera_matrix: " + std::string(5000, '[')}) {
    CAPTURE(text.substr(0, 60));
    const auto reading = read_with("a.xml", text, "calibration: a.xml");
    CHECK_FALSE(reading.value.has_value());
    CHECK(has_errors(reading.diagnostics));
  }
}
