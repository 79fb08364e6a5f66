// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "decoder/image/load.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/base/text.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// A rig of small images, so that the tests are quick.
constexpr const char* kRig = R"(rig: small
cameras:
  left:  { image_size: [320, 240], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6], alpha: 35, side: left }
  right: { image_size: [320, 240], focal_length_mm: 6.0, sensor_mm: [4.8, 3.6], alpha: 35, side: right }
ranges:
  d: { wall: left, min: 0.25, max: 5.0, sigma: 0.01 }
vehicle: { height: 0.24, roll_sigma: 2, pitch_sigma: 2 }
)";

constexpr const char* kRun =
    "id,left,truth_x,truth_y,truth_z\n1,,1.0,-0.5,0.24\nb2,,0.5,0.5,0.24\n";

struct Desk {
  TemporaryFolder folder;

  explicit Desk(const std::string& run = kRun, const std::string& rig = kRig) {
    REQUIRE(write_file(folder.path() / "rig.yaml", rig));
    REQUIRE(write_file(folder.path() / "run.csv", run));
  }

  fs::path out() const { return folder.path() / "out"; }

  ProgramOutput simulate(const std::string& more = "",
                         const std::string& survey = "surveys/corridor/survey.yaml") const {
    const std::string at = folder.path().string();
    return run_tagsmith("simulate " + survey + " --rig '" + at + "/rig.yaml' --run '" + at +
                        "/run.csv' -o '" + out().string() + "' " + more);
  }
};

TEST_CASE("simulate writes the images, a run that refers to them, and the truth") {
  const Desk desk;
  const ProgramOutput output = desk.simulate();
  CAPTURE(output.err);
  REQUIRE(output.exit_code == 0);
  CHECK(output.err.empty());
  for (const char* name : {"1_left.png", "1_right.png", "b2_left.png", "b2_right.png"}) {
    const auto image = load_gray_image(desk.out() / name);
    REQUIRE(image);
    CHECK(image->width == 320);
  }
  const auto lines = split(contents(desk.out() / "run.csv"), '\n');
  REQUIRE(lines.size() == 4);
  CHECK(lines[0] == "id,left,right,d,truth_x,truth_y,truth_z,truth_heading,time");
  const auto fields = split(lines[2], ',');
  CHECK(fields[1] == "b2_left.png");
  CHECK(std::abs(*parse_number(fields[3]) - 1.4) < 0.05);
  CHECK(fields[4] == "0.5");
  const Json truth = Json::parse(contents(desk.out() / "truth.json"));
  CHECK(truth["check"] == "sum10");
  CHECK(truth["images"].size() == 4);
  CHECK(truth["images"][0]["plates"][0]["code"] == "019000000404");
  CHECK(truth["images"][0]["plates"][0]["corners_px"]["P"].size() == 2);
}

TEST_CASE("The run written can be simulated again") {
  const Desk desk;
  REQUIRE(desk.simulate().exit_code == 0);
  const std::string at = desk.folder.path().string();
  const ProgramOutput again =
      run_tagsmith("simulate surveys/corridor/survey.yaml --rig '" + at + "/rig.yaml' --run '" +
                   at + "/out/run.csv' -o '" + at + "/again'");
  CAPTURE(again.err);
  REQUIRE(again.exit_code == 0);
  CHECK(contents(desk.folder.path() / "again" / "1_left.png") ==
        contents(desk.out() / "1_left.png"));
}

TEST_CASE("A camera chain changes the pictures, none does not, and JPEG files hold the same") {
  const Desk desk;
  REQUIRE(desk.simulate().exit_code == 0);
  const std::string plain = contents(desk.out() / "1_left.png");
  REQUIRE(desk.simulate("--camera-chain none --force").exit_code == 0);
  CHECK(contents(desk.out() / "1_left.png") == plain);
  REQUIRE(desk.simulate("--camera-chain strong --force").exit_code == 0);
  CHECK(contents(desk.out() / "1_left.png") != plain);
  REQUIRE(desk.simulate("--camera-chain strong --format jpg --force").exit_code == 0);
  const auto png = load_gray_image(desk.out() / "1_left.png");
  const auto jpg = load_gray_image(desk.out() / "1_left.jpg");
  REQUIRE(png);
  REQUIRE(jpg);
  CHECK(png->samples == jpg->samples);
}

TEST_CASE("Options that a camera chain excludes or that need one are refused") {
  const Desk desk;
  const ProgramOutput linear = desk.simulate("--camera-chain mild --linear");
  CHECK(linear.exit_code == 2);
  CHECK(linear.err.find("exclude each other") != std::string::npos);
  const ProgramOutput rolling = desk.simulate("--rolling-shutter 5");
  CHECK(rolling.exit_code == 2);
  CHECK(rolling.err.find("needs --camera-chain") != std::string::npos);
}

TEST_CASE("--json gives one object an image and the summary last") {
  const Desk desk;
  const ProgramOutput output = desk.simulate("--json");
  REQUIRE(output.exit_code == 0);
  const auto lines = split(output.out, '\n');
  REQUIRE(lines.size() == 6);
  CHECK(Json::parse(lines[0])["file"] == "1_left.png");
  CHECK(Json::parse(lines[4])["summary"]["images"] == 4);
}

TEST_CASE("Seed and number of jobs: the one decides the result, the other does not") {
  const Desk desk;
  REQUIRE(desk.simulate("--jobs 1 --seed 7").exit_code == 0);
  const std::string first = contents(desk.out() / "1_left.png");
  const std::string run = contents(desk.out() / "run.csv");
  REQUIRE(desk.simulate("--jobs 4 --seed 7 --force").exit_code == 0);
  CHECK(contents(desk.out() / "1_left.png") == first);
  CHECK(contents(desk.out() / "run.csv") == run);
  REQUIRE(desk.simulate("--seed 8 --force").exit_code == 0);
  CHECK(contents(desk.out() / "1_left.png") != first);
  CHECK(contents(desk.out() / "run.csv") != run);
}

TEST_CASE("Format, blur, noise and tone change the images") {
  const Desk desk;
  REQUIRE(desk.simulate("--noise 0").exit_code == 0);
  const auto plain = load_gray_image(desk.out() / "1_left.png");
  REQUIRE(plain);
  for (const std::string option : {"--blur 2 --noise 0", "--noise 5", "--linear --noise 0"}) {
    CAPTURE(option);
    REQUIRE(desk.simulate(option + " --force").exit_code == 0);
    const auto changed = load_gray_image(desk.out() / "1_left.png");
    REQUIRE(changed);
    CHECK(changed->samples != plain->samples);
  }
  REQUIRE(desk.simulate("--format jpg --quality 80 --force").exit_code == 0);
  CHECK(load_gray_image(desk.out() / "1_left.jpg"));
}

TEST_CASE("A folder with something in it is left alone without --force") {
  const Desk desk;
  REQUIRE(write_file(desk.out() / "mine.txt", "mine"));
  const ProgramOutput output = desk.simulate();
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("not empty") != std::string::npos);
  CHECK(output.out.empty());
  CHECK(std::distance(fs::directory_iterator(desk.out()), {}) == 1);
  REQUIRE(desk.simulate("--force").exit_code == 0);
  CHECK(contents(desk.out() / "mine.txt") == "mine");
}

struct WrongRun {
  std::string name;
  const char* rows;
  const char* message;
};

TEST_CASE("Rows that cannot be simulated are named and nothing is written") {
  const WrongRun wrong_runs[] = {
      {"no truth", "1,,1,-0.5,0.24\n2,,,,\n", "run.csv:3: no true position"},
      {"beside the tunnel", "1,,2.4,0,0.24\n", "run.csv:2: the true position is 1.45 m left"},
      {"under the floor", "1,,1,0,-0.1\n", "run.csv:2: the true position is -0.1 m above"},
      {"id with a path", "../x,,1,0,0.24\n", "run.csv:2: the id `../x`"},
      {"same name twice", "a,,1,0,0.24\na,,1,1,0.24\n", "run.csv:3"},
      {"no number", "1,,one,0,0.24\n", "run.csv:2:3"},
  };
  for (const WrongRun& wrong : wrong_runs) {
    CAPTURE(wrong.name);
    const Desk desk(std::string("id,left,truth_x,truth_y,truth_z\n") + wrong.rows);
    const ProgramOutput output = desk.simulate();
    CAPTURE(output.err);
    CHECK(output.exit_code == 2);
    CHECK(output.err.find(wrong.message) != std::string::npos);
    CHECK(output.out.empty());
    CHECK_FALSE(fs::exists(desk.out()));
  }
}

TEST_CASE("A camera beside the tunnel is an error") {
  std::string rig = kRig;
  rig.replace(rig.find("alpha: 35, side: left"), 21, "yaw: 55, position: [0, 1.5, 0]");
  const Desk desk(kRun, rig);
  const ProgramOutput output = desk.simulate();
  CAPTURE(output.err);
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("run.csv:2: ") != std::string::npos);
}

TEST_CASE("Wrong use and unreadable input") {
  const Desk desk;
  for (const std::string option :
       {"--blur -1", "--blur nan", "--blur 1e9", "--noise x", "--jobs -3", "--format gif",
        "--quality 80", "--format jpg --quality 80 --camera-chain mild", "--format jpg --quality 0",
        "--seed -1", "--nothing"}) {
    CAPTURE(option);
    const ProgramOutput output = desk.simulate(option);
    CHECK(output.exit_code == 2);
    CHECK(output.out.empty());
    CHECK_FALSE(output.err.empty());
  }
  CHECK(desk.simulate("", "no/such/survey.yaml").exit_code == 2);
  CHECK_FALSE(fs::exists(desk.out()));
}

TEST_CASE("A place that cannot be written is an error") {
  const Desk desk;
  const std::string at = desk.folder.path().string();
  for (const std::string& place : {std::string("/proc/no/such/folder"), at + "/run.csv"}) {
    CAPTURE(place);
    const ProgramOutput output =
        run_tagsmith("simulate surveys/corridor/survey.yaml --rig '" + at + "/rig.yaml' --run '" +
                     at + "/run.csv' -o '" + place + "'");
    CHECK(output.exit_code == 2);
    CHECK_FALSE(output.err.empty());
  }
}

TEST_CASE("--help shows an example") {
  const ProgramOutput output = run_tagsmith("simulate --help");
  CHECK(output.exit_code == 0);
  CHECK(output.out.find("tagsmith simulate surveys/curved/survey.yaml") != std::string::npos);
}

}  // namespace
}  // namespace tagsmith::detail::test
