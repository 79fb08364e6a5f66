// SPDX-License-Identifier: Apache-2.0
// From calibrated cameras to the files that a located run is written to.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/localize/runs.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

using nlohmann::json;
using tagsmith::detail::test::contents;
using tagsmith::detail::test::count_lines;
using tagsmith::detail::test::file_with;
using tagsmith::detail::test::json_lines;
using tagsmith::detail::test::on_survey;
using tagsmith::detail::test::parsed_json;
using tagsmith::detail::test::ProgramOutput;
using tagsmith::detail::test::run_tagsmith;
using tagsmith::detail::test::TemporaryFolder;
using tagsmith::detail::test::with_other_noise;
namespace fs = std::filesystem;

namespace {

// The vehicle stands at the corridor's first point; then it sees nothing for a tenth of a second.
// Two rows of the same place, with photos in `folder`, and one that saw nothing.
std::string run_with_times(const fs::path& folder) {
  const std::string photos = fs::absolute("surveys/corridor/photos").string();
  const std::string left = photos + "/corridor_01_left.jpg";
  const std::string right = photos + "/corridor_01_right.jpg";
  return "id,left,right,time,truth_x,truth_y,truth_z\na," + left + "," + right +
         ",10.0,1.0,-0.5,0.24\nb," + with_other_noise(folder, left) + "," +
         with_other_noise(folder, right) + ",10.4,1.0,-0.5,0.24\nc,,,10.5,1.0,-0.5,0.24\n";
}

}  // namespace

TEST_CASE("calibrated cameras, one a fisheye: what is simulated is read and located") {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  file_with(folder.path() / "left.yml",
            "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 960\nfisheye_model: 1\n"
            "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
            "   data: [ 620., 0., 645., 0., 622., 470., 0., 0., 1. ]\n"
            "distortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n"
            "   data: [ -0.03, 0.01, -0.004, 0.0007 ]\n");
  file_with(folder.path() / "chain.yaml",
            "cam0:\n  camera_model: pinhole\n  intrinsics: [1205.3, 1204.1, 650.2, 471.9]\n"
            "  distortion_model: radtan\n  distortion_coeffs: [-0.28, 0.09, 0.001, -0.0015]\n"
            "  resolution: [1280, 960]\n");
  file_with(folder.path() / "rig.yaml",
            "rig: wide\ncameras:\n  left:  { calibration: left.yml, alpha: 20, side: left }\n"
            "  right: { calibration: chain.yaml, alpha: 35, side: right }\n"
            "ranges:\n  d: { wall: left, min: 0.25, max: 5.0, sigma: 0.0001 }\n"
            "vehicle: { height: 0.24 }\n");
  file_with(folder.path() / "places.csv", "id,left,truth_x,truth_y,truth_z\n1,,1.0,0.3,0.24\n");
  const std::string survey =
      "surveys/corridor/survey.yaml --rig '" + at + "/rig.yaml' --run '" + at;
  const ProgramOutput simulated =
      run_tagsmith("simulate " + survey + "/places.csv' -o '" + at + "/out'");
  CAPTURE(simulated.err);
  REQUIRE(simulated.exit_code == 0);
  const json truth = parsed_json(contents(folder.path() / "out/truth.json"));
  CHECK(truth.at("images").at(0).at("camera").at("model") == "fisheye");
  CHECK(truth.at("images").at(0).at("camera").at("distortion").size() == 4);
  CHECK(truth.at("images").at(1).at("camera").at("distortion").size() == 5);

  const ProgramOutput located =
      run_tagsmith("localize " + survey + "/out/run.csv' --method paper --json");
  CAPTURE(located.out);
  const std::vector<json> lines = json_lines(located.out);
  REQUIRE(lines.size() == 2);
  REQUIRE(lines[0].at("status") == "ok");
  CHECK(lines[0].at("error_plane").get<double>() < 0.02);

  // The same photos with a calibration of another size.
  fs::copy_file("surveys/corridor/photos/corridor_01_left.jpg", folder.path() / "other.jpg");
  file_with(folder.path() / "chain.yaml",
            "cam0:\n  camera_model: pinhole\n  intrinsics: [600, 600, 320, 240]\n"
            "  distortion_model: none\n  resolution: [640, 480]\n");
  file_with(folder.path() / "other.csv", "id,right\n1,other.jpg\n");
  const ProgramOutput refused = run_tagsmith("localize " + survey + "/other.csv' --json");
  CHECK(refused.exit_code == 1);
  CHECK(refused.out.find("1280 x 960 ") != std::string::npos);
  CHECK(refused.out.find(" 640 x 480") != std::string::npos);
}

TEST_CASE("a run as trajectory, table and drawing") {
  const TemporaryFolder folder;
  const fs::path run = folder.path() / "run.csv";
  file_with(run, run_with_times(folder.path()));
  const std::string at = "'" + folder.path().string();
  const ProgramOutput output =
      run_tagsmith(on_survey("corridor", "'" + run.string() + "'") + " --csv " + at +
                   "/fixes.csv' --tum " + at + "/run.tum' --drawing " + at + "/run.svg'");
  CAPTURE(output.out + output.err);
  CHECK(output.exit_code == 1);  // the last row has no position
  CHECK(output.out.find("Xu et al. 2017, straight corridor") != std::string::npos);

  std::istringstream tum(contents(folder.path() / "run.tum"));
  std::string comment;
  std::getline(tum, comment);
  CHECK(comment.starts_with("#"));
  double t = 0;
  double x = 0;
  double y = 0;
  double z = 0;
  double qx = 0;
  double qy = 0;
  double qz = 0;
  double qw = 0;
  int rows = 0;
  while (tum >> t >> x >> y >> z >> qx >> qy >> qz >> qw) {
    CHECK(t == doctest::Approx(rows == 0 ? 10.0 : 10.4));
    CHECK(std::abs(x + 1.0) < 0.02);
    CHECK(std::abs(y + 0.5) < 0.02);
    CHECK(std::abs(z - 0.24) < 0.02);
    CHECK(qx * qx + qy * qy + qz * qz + qw * qw == doctest::Approx(1));
    // Its x axis looks along the drive, +y.
    CHECK(2 * (qx * qy + qz * qw) > 0.98);
    ++rows;
  }
  CHECK(rows == 2);

  const std::string csv = contents(folder.path() / "fixes.csv");
  CHECK(csv.find("id,status,method,survey,x,y,z,heading_deg,") == 0);
  CHECK(count_lines(csv) == 4);
  const std::string svg = contents(folder.path() / "run.svg");
  for (const char* layer : {"truth", "fixes", "ellipses", "errors", "walls", "summary"}) {
    CHECK(svg.find("id=\"" + std::string(layer) + "\"") != std::string::npos);
  }
}

TEST_CASE("what cannot be written is refused, and nothing is written") {
  const TemporaryFolder folder;
  const std::string at = "'" + folder.path().string();
  const std::string table4 = on_survey("corridor-table4", "surveys/corridor-table4/run.csv");
  const ProgramOutput no_heading = run_tagsmith(table4 + " --method paper --tum " + at +
                                                "/run.tum' --csv " + at + "/fixes.csv'");
  CHECK(no_heading.exit_code == 2);
  CHECK(no_heading.err.find("the paper's method gives no heading") != std::string::npos);
  const ProgramOutput format = run_tagsmith(table4 + " --drawing " + at + "/run.dwg'");
  CHECK(format.exit_code == 2);
  CHECK(format.err.find(".pdf, .svg or .png") != std::string::npos);
  const ProgramOutput no_time =
      run_tagsmith(on_survey("corridor", "surveys/corridor/run.csv") + " --smooth");
  CHECK(no_time.exit_code == 2);
  CHECK(no_time.err.find("run.csv:2: ") != std::string::npos);
  CHECK(fs::is_empty(folder.path()));
}

TEST_CASE("--smooth with --explain is refused: no option is dropped in silence") {
  const ProgramOutput both =
      run_tagsmith(on_survey("corridor", "surveys/corridor/run.csv") + " --smooth --explain");
  CHECK(both.exit_code == 2);
  CHECK(both.out.empty());
  CHECK(both.err.find("--explain") != std::string::npos);
}

TEST_CASE("--smooth predicts what the cameras did not see") {
  const TemporaryFolder folder;
  const fs::path run = folder.path() / "run.csv";
  file_with(run, run_with_times(folder.path()));
  const ProgramOutput output =
      run_tagsmith(on_survey("corridor", "'" + run.string() + "'") + " --smooth --json");
  CAPTURE(output.out + output.err);
  CHECK(output.exit_code == 0);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 4);
  CHECK_FALSE(lines[0].contains("predicted"));
  CHECK(lines[2].at("predicted") == true);
  CHECK(lines[2].at("status") == "ok");
  CHECK(lines[2].at("tags").empty());
  CHECK(lines[2].at("covariance").at(4) > lines[1].at("covariance").at(4));
  CHECK(lines[2].at("error_plane").get<double>() < 0.05);
}
