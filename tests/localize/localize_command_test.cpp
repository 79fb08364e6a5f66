// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tests/localize/runs.hpp"
#include "tests/support/program.hpp"
#include "tests/support/tilted_corridor.hpp"

using nlohmann::json;
using tagsmith::detail::test::contents;
using tagsmith::detail::test::count_lines;
using tagsmith::detail::test::file_with;
using tagsmith::detail::test::json_lines;
using tagsmith::detail::test::on_survey;
using tagsmith::detail::test::ProgramOutput;
using tagsmith::detail::test::run_tagsmith;
using tagsmith::detail::test::TemporaryFolder;
using tagsmith::detail::test::tilted_corridor;
namespace fs = std::filesystem;

namespace {

std::string by_paper(const std::string& name, const std::string& run) {
  return on_survey(name, run) + " --method paper";
}

}  // namespace

TEST_CASE("Table 4 through the command line, with the d that its results imply") {
  const ProgramOutput output =
      run_tagsmith(by_paper("corridor-table4", "surveys/corridor-table4/run.csv") + " --json");
  CHECK(output.exit_code == 0);
  CHECK(output.err.empty());
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 11);
  const json& first = lines.front();
  CHECK(first.at("id") == "1");
  CHECK(first.at("status") == "ok");
  CHECK(first.at("method") == "paper");
  CHECK(first.at("position").at(0).get<double>() == doctest::Approx(0.980).epsilon(0.001));
  CHECK(first.at("position").at(1).get<double>() == doctest::Approx(-0.419).epsilon(0.001));
  CHECK(first.at("position").at(2).get<double>() == doctest::Approx(0.151).epsilon(0.005));
  CHECK(first.at("heading_deg").is_null());
  CHECK(first.at("covariance").size() == 9);
  CHECK(first.at("covariance").at(1) == first.at("covariance").at(3));
  CHECK(first.at("covariance").at(0).get<double>() > 0);
  CHECK(first.at("tags") == json({"000L", "000R"}));
  CHECK(first.at("reason").is_null());
  CHECK(first.at("error_plane").get<double>() == doctest::Approx(0.083).epsilon(0.01));
  CHECK(first.at("error_z").get<double>() == doctest::Approx(0.089).epsilon(0.01));
  const json& summary = lines.back().at("summary");
  CHECK(summary.at("count") == 10);
  CHECK(summary.at("located") == 10);
  CHECK(summary.at("mean_error_plane").get<double>() == doctest::Approx(0.142).epsilon(0.005));
  CHECK(summary.at("mean_error_z").get<double>() == doctest::Approx(0.083).epsilon(0.005));
}

TEST_CASE("Table 4 with its printed d stays within the residuals of its rounding") {
  const ProgramOutput printed = run_tagsmith(
      by_paper("corridor-table4", "surveys/corridor-table4/run-printed-d.csv") + " --json");
  const ProgramOutput implied =
      run_tagsmith(by_paper("corridor-table4", "surveys/corridor-table4/run.csv") + " --json");
  CHECK(printed.exit_code == 0);
  const std::vector<json> a = json_lines(printed.out);
  const std::vector<json> b = json_lines(implied.out);
  REQUIRE(a.size() == 11);
  REQUIRE(b.size() == 11);
  const double limits[] = {0.0035, 0.0145, 0.0335};
  for (std::size_t i = 0; i < 10; ++i) {
    CAPTURE(i + 1);
    const bool odd = i == 1 || i == 8;  // their printed d contradicts their printed result
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double moved =
          a[i].at("position").at(axis).get<double>() - b[i].at("position").at(axis).get<double>();
      if (!odd) CHECK(std::abs(moved) < limits[axis]);
      if (odd && axis == 1)
        CHECK(std::abs(moved) == doctest::Approx(i == 1 ? 0.060 : 0.039).epsilon(0.02));
    }
  }
}

TEST_CASE("the corridor photos: what is located is near the truth, the rest has its reason") {
  const ProgramOutput output =
      run_tagsmith(by_paper("corridor", "surveys/corridor/run.csv") + " --json");
  CHECK(output.exit_code == 1);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 11);
  int located = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    CHECK(lines[i].at("id") == std::to_string(i + 1));
    CHECK(lines[i].at("tags").size() == 2);
    if (lines[i].at("status") == "ok") {
      ++located;
      CHECK(lines[i].at("error_plane").get<double>() < 0.15);
      CHECK(lines[i].at("error_z").get<double>() < 0.2);
    } else {
      CHECK(lines[i].at("status") == "no_position");
      CHECK(lines[i].at("position").is_null());
      CHECK(lines[i].at("covariance").is_null());
      CHECK(lines[i].at("reason").get<std::string>().find("no real solution") != std::string::npos);
      CHECK_FALSE(lines[i].contains("error_z"));
    }
  }
  CHECK(located == lines.back().at("summary").at("located").get<int>());
  CHECK(located >= 2);
}

TEST_CASE("without a survey tags are taken where their digits say") {
  const std::string seen =
      "localize --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv";
  const ProgramOutput output = run_tagsmith(seen + " --template tag-400x300 --width 1.9 --json");
  CHECK(output.exit_code == 0);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 11);
  for (std::size_t i = 0; i < 10; ++i) {
    CHECK(lines[i].at("tags").size() >= 2);
    // Digits are rounded to centimetres.
    CHECK(lines[i].at("error_plane").get<double>() < 0.02);
    CHECK(lines[i].at("error_z").get<double>() < 0.02);
    CHECK(lines[i].at("covariance").at(0).get<double>() > 1e-6);
  }
  CHECK(output.err.find("no survey") != std::string::npos);
  CHECK(lines.back().at("summary").at("assumed").at(0).get<std::string>().starts_with("no survey"));

  // In a tunnel of another width the digits are on no wall.
  const ProgramOutput wide = run_tagsmith(seen + " --template tag-400x300 --width 2.6 --json");
  CHECK(wide.exit_code == 1);
  for (const json& line : json_lines(wide.out)) {
    if (!line.contains("id")) continue;
    for (const json& tag : line.at("tags")) CHECK(tag.get<std::string>().substr(0, 4) == "0000");
  }

  for (const char* wrong :
       {" --template tag-400x300", " --width 1.9", "", " --template no-such --width 2",
        " --template tag-400x300 --width 1.9 --method paper",
        " --template tag-400x300 --width 1.9 surveys/corridor/survey.yaml"}) {
    CAPTURE(wrong);
    CHECK(run_tagsmith(seen + wrong).exit_code == 2);
  }
}

TEST_CASE("the number of jobs changes nothing in the output") {
  const std::string arguments = by_paper("corridor", "surveys/corridor/run.csv") + " --json";
  CHECK(run_tagsmith(arguments + " --jobs 1").out == run_tagsmith(arguments + " --jobs 3").out);
}

TEST_CASE("the paper's own pipeline can read the images") {
  const ProgramOutput output =
      run_tagsmith(by_paper("corridor", "surveys/corridor/run.csv") + " --reader paper --json");
  CHECK(output.exit_code == 1);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 11);
  // Another plate, cut by the border, is the second largest white area of the left image.
  CHECK(lines[1].at("reason").get<std::string>().find(
            "corridor_02_left.jpg: no tag read (scan the rows") != std::string::npos);
  CHECK(lines[9].at("tags") == json({"007L", "007R"}));
}

TEST_CASE("the table for people names the points, positions and errors") {
  const ProgramOutput output =
      run_tagsmith(by_paper("corridor-table4", "surveys/corridor-table4/run.csv"));
  CHECK(output.exit_code == 0);
  CHECK(output.out.find("000L 000R      0.980    -0.419     0.151") != std::string::npos);
  CHECK(output.out.find(
            "10 measurements, 10 located; mean error 0.1416 m in the plane, 0.0831 m in z; 95 % "
            "0.2695 m, 0.1870 m; greatest 0.2695 m, 0.1870 m\nfor comparison, Xu et al. 2017, "
            "straight corridor: "
            "mean error 0.142 m in the plane, 0.083 m in z\n") != std::string::npos);
}

TEST_CASE("positions go to a file too") {
  const TemporaryFolder folder;
  const fs::path fixes = folder.path() / "fixes.csv";
  const ProgramOutput output = run_tagsmith(
      by_paper("corridor-table4", "surveys/corridor-table4/run.csv") + " -o " + fixes.string());
  CHECK(output.exit_code == 0);
  const std::string text = contents(fixes);
  CHECK(text.starts_with("id,status,method,survey,x,y,z,"));
  CHECK(count_lines(text) == 11);
  CHECK(text.find("\n1,ok,paper,corridor-table4,0.98000") != std::string::npos);
}

TEST_CASE("a missing or broken image costs its own row only") {
  const TemporaryFolder folder;
  const fs::path photos = fs::absolute("surveys/corridor/photos");
  file_with(folder.path() / "broken.jpg", "not a picture");
  const std::string good_left = (photos / "corridor_05_left.jpg").string();
  const std::string good_right = (photos / "corridor_05_right.jpg").string();
  const std::string run = file_with(folder.path() / "run.csv",
                                    "id,left,right,d\n"
                                    "missing,nowhere.jpg," +
                                        good_right +
                                        ",0.894\n"
                                        "broken," +
                                        good_left +
                                        ",broken.jpg,0.894\n"
                                        "none,,,0.894\n"
                                        "far," +
                                        good_left + "," + good_right +
                                        ",7\n"
                                        "good," +
                                        good_left + "," + good_right + ",0.894\n");
  const ProgramOutput output = run_tagsmith(by_paper("corridor", run) + " --json");
  CHECK(output.exit_code == 1);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 6);
  const auto reason = [&](std::size_t i) { return lines[i].at("reason").get<std::string>(); };
  CHECK(reason(0).find("nowhere.jpg") != std::string::npos);
  CHECK(lines[0].at("tags") == json::array({"003R"}));
  CHECK(reason(1).find("broken.jpg") != std::string::npos);
  CHECK(reason(2) == "no tag was seen");
  CHECK(reason(3) == "d is 7 m, expected 0.25 to 5 m");
  CHECK(lines[4].at("status") == "ok");
  CHECK(lines[5].at("summary").at("located") == 1);
  CHECK_FALSE(lines[5].at("summary").contains("mean_error_plane"));
}

TEST_CASE("a position from a damaged image says so, by both methods and by name") {
  const TemporaryFolder folder;
  const fs::path photos = fs::absolute("surveys/corridor/photos");
  std::string jpeg = *tagsmith::detail::read_file(photos / "corridor_05_left.jpg");
  jpeg.erase(jpeg.size() - 3'000, 2'000);
  REQUIRE(tagsmith::detail::write_file(folder.path() / "worn.jpg", jpeg).has_value());
  const std::string run = file_with(
      folder.path() / "run.csv",
      "id,left,right,d\n5,worn.jpg," + (photos / "corridor_05_right.jpg").string() + ",0.894\n");
  for (const char* method : {"joint", "paper"}) {
    CAPTURE(method);
    const ProgramOutput output = run_tagsmith(
        "localize surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --run '" + run +
        "' --json --method " + method);
    const std::vector<json> lines = json_lines(output.out);
    REQUIRE(lines.size() == 2);
    const std::string told = lines[0].dump();
    CHECK(told.find("worn.jpg: the file is damaged, and a part of the picture may be wrong: ") !=
          std::string::npos);
    CHECK(output.err.find("Corrupt JPEG") == std::string::npos);
  }
}

TEST_CASE("wrong use and unreadable input are exit code 2, on standard error") {
  const TemporaryFolder folder;
  const std::string table4 = "surveys/corridor-table4/";
  const std::string run = table4 + "run.csv";
  const std::string broken_run = file_with(folder.path() / "run.csv", "id,middle,d\n1,x.jpg,abc\n");
  const std::string file = file_with(folder.path() / "file", "");
  const std::vector<std::string> wrong = {
      "localize",
      "localize " + table4 + "survey.yaml --run " + run,
      "localize no/survey.yaml --rig " + table4 + "rig.yaml --run " + run,
      "localize " + table4 + "survey.yaml --rig no/rig.yaml --run " + run,
      "localize " + table4 + "survey.yaml --rig " + table4 + "rig.yaml --run no/run.csv",
      "localize " + table4 + "survey.yaml --rig " + table4 + "survey.yaml --run " + run,
      on_survey("corridor-table4", broken_run),
      on_survey("corridor-table4", run) + " --method joyful",
      on_survey("corridor-table4", run) + " --reader mine",
      on_survey("corridor-table4", run) + " --jobs -1",
      on_survey("corridor-table4", run) + " -o " + file + "/inside/fixes.csv",
  };
  for (const std::string& arguments : wrong) {
    CAPTURE(arguments);
    const ProgramOutput output = run_tagsmith(arguments);
    CHECK(output.exit_code == 2);
    CHECK(output.out.empty());
    CHECK_FALSE(output.err.empty());
  }
}

TEST_CASE("the joint fit locates the shipped photos to fractions of a millimetre") {
  for (const std::string name : {"corridor", "curved"}) {
    CAPTURE(name);
    const ProgramOutput output =
        run_tagsmith(on_survey(name, "surveys/" + name + "/run.csv") + " --json --explain");
    CHECK(output.exit_code == 0);
    const std::vector<json> lines = json_lines(output.out);
    REQUIRE(lines.size() >= 7);
    const json& summary = lines.back().at("summary");
    CHECK(summary.at("located") == summary.at("count"));
    CHECK(summary.at("mean_error_plane").get<double>() < 0.0005);
    CHECK(summary.at("mean_error_z").get<double>() < 0.0005);
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
      CHECK(lines[i].at("method") == "joint");
      CHECK(lines[i].at("heading_sigma_deg").get<double>() < 0.1);
      double sum = 0;
      for (const auto& [source, sigmas] : lines[i].at("budget").items()) {
        sum += std::pow(sigmas.at(0).get<double>(), 2);
      }
      CHECK(sum == doctest::Approx(lines[i].at("covariance").at(0).get<double>()));
    }
  }
}

TEST_CASE(
    "what survey and rig leave unsaid is assumed and said once, and right photos keep right") {
  const TemporaryFolder folder;
  std::string rig = contents("surveys/corridor/rig.yaml");
  for (std::size_t at = 0; (at = rig.find(", sigma: 0 }")) != std::string::npos;) {
    rig.erase(at, 10);
  }
  const std::string arguments = "localize surveys/corridor/survey.yaml --rig " +
                                file_with(folder.path() / "rig.yaml", rig) +
                                " --run surveys/corridor/run.csv";
  const ProgramOutput output = run_tagsmith(arguments + " --json");
  CHECK(output.exit_code == 0);
  const std::string assumed =
      "rig crawler does not state the whole sigma of camera left, right: edge 0.1 pixels, position "
      "5 mm, angle "
      "0.5 "
      "degrees, focal 2 %, center 12.8 pixels, distortion 2 % at the image's corners (by data "
      "sheet) "
      "assumed";
  const std::string shutter =
      "rig crawler states no readout and no delay of camera left, right: global shutters, "
      "triggered "
      "together, assumed";
  CHECK(output.err == "tagsmith localize: " + assumed + "\ntagsmith localize: " + shutter + "\n");
  const json summary = json_lines(output.out).back().at("summary");
  CHECK(summary.at("assumed") == json::array({assumed, shutter}));
  CHECK(summary.at("located") == 10);
  const ProgramOutput stated =
      run_tagsmith(on_survey("corridor", "surveys/corridor/run.csv") + " --json");
  CHECK(stated.err.empty());
  CHECK(json_lines(stated.out).back().at("summary").at("assumed").empty());
}

TEST_CASE("one camera is enough, a gross range is dropped and said, no tag has its reason") {
  const TemporaryFolder folder;
  const fs::path photos = fs::absolute("surveys/corridor/photos");
  const std::string left = (photos / "corridor_05_left.jpg").string();
  const std::string right = (photos / "corridor_05_right.jpg").string();
  const std::string run = file_with(folder.path() / "run.csv",
                                    "id,left,right,d,truth_x,truth_y,truth_z\n"
                                    "one," +
                                        left +
                                        ",,,1,2,0.24\n"
                                        "gross," +
                                        left + "," + right +
                                        ",2.5,1,2,0.24\n"
                                        "none,,,0.9,1,2,0.24\n");
  const ProgramOutput output = run_tagsmith(on_survey("corridor", run) + " --json");
  CHECK(output.exit_code == 1);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 4);
  CHECK(lines[0].at("tags") == json({"003L", "004L"}));  // half of the second is in the picture
  CHECK(lines[0].at("error_plane").get<double>() < 0.001);
  CHECK(lines[1].at("error_plane").get<double>() < 0.001);
  REQUIRE(lines[1].at("dropped").size() == 1);
  CHECK(lines[1].at("dropped")[0].at("name") == "d");
  CHECK(lines[2].at("status") == "no_position");
  CHECK(lines[2].at("reason") == "no tag was seen");
}

TEST_CASE("positions that nothing confirms are told, and refused on request") {
  const TemporaryFolder folder;
  const fs::path photos = fs::current_path() / "surveys/corridor/photos";
  const std::string left = (photos / "corridor_10_left.jpg").string();
  const std::string right = (photos / "corridor_10_right.jpg").string();
  const std::string run =
      file_with(folder.path() / "run.csv",
                "id,left,right\none," + left + ",\ntwo," + left + "," + right + "\n");
  const ProgramOutput any = run_tagsmith(on_survey("corridor", run) + " --json");
  CHECK(any.exit_code == 0);
  const std::vector<json> lines = json_lines(any.out);
  REQUIRE(lines.size() == 3);
  CHECK(lines[0].at("status") == "ok");
  CHECK(lines[0].at("confirmations") == 0);
  CHECK(lines[1].at("confirmations") == 1);
  CHECK(lines[2].at("summary").at("confirmed") == 1);
  const ProgramOutput sure = run_tagsmith(on_survey("corridor", run) + " --json --confirmed");
  CHECK(sure.exit_code == 1);
  const std::vector<json> confirmed = json_lines(sure.out);
  REQUIRE(confirmed.size() == 3);
  CHECK(confirmed[0].at("status") == "no_position");
  CHECK(confirmed[0].at("reason") ==
        "nothing confirms what 007L says: a wrong plate would go unnoticed");
  CHECK(confirmed[1] == lines[1]);
}

TEST_CASE("both methods stand beside each other, and residuals are drawn") {
  const TemporaryFolder folder;
  const fs::path pictures = folder.path() / "residuals";
  const ProgramOutput output =
      run_tagsmith(on_survey("curved", "surveys/curved/run.csv") +
                   " --method both --json --residuals " + pictures.string());
  CHECK(output.exit_code == 0);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 13);
  CHECK(lines[0].at("method") == "joint");
  CHECK(lines[1].at("method") == "paper");
  CHECK(lines.back().at("summary").at("paper").at("located") == 0);
  CHECK(contents(pictures / "001-1.svg").starts_with("<svg"));
}

TEST_CASE("live measurements are answered a line each") {
  const TemporaryFolder folder;
  const std::string input = file_with(
      folder.path() / "input",
      "{\"id\": \"a\", \"left\": \"surveys/corridor/photos/corridor_01_left.jpg\", \"d\": 0.9}\n"
      "nonsense\n{\"id\": \"c\", \"lefd\": \"x.jpg\"}\n{\"id\": 4}\n{\"id\": " +
          std::string(100'000, '[') + std::string(100'000, ']') + "}");
  const ProgramOutput output = run_tagsmith(
      "localize surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --follow < " + input);
  CHECK(output.exit_code == 1);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 5);
  CHECK(lines[0].at("status") == "ok");
  CHECK(lines[0].at("id") == "a");
  CHECK(lines[1].at("status") == "error");
  CHECK(lines[1].at("id").is_null());
  CHECK(lines[2].at("id") == "c");
  CHECK(lines[2].at("reason").get<std::string>().find("line 3: `lefd`") == 0);
  CHECK(lines[3].at("reason") == "no tag was seen");
  CHECK(lines[4].at("status") == "error");
  CHECK(lines[4].at("id").is_null());
}

TEST_CASE("live measurements do not use a picture of another time again, whatever the method") {
  const TemporaryFolder folder;
  std::string lines;
  for (int time = 1; time <= 2; ++time) {
    lines += fmt::format(
        R"({{"id": "{}", "time": {}, "left": "surveys/corridor/photos/corridor_05_left.jpg",)"
        R"( "right": "surveys/corridor/photos/corridor_05_right.jpg", "d": 0.9}})"
        "\n",
        time, time);
  }
  const std::string input = file_with(folder.path() / "input", lines);
  for (const char* method : {"", " --unsurveyed", " --reader paper"}) {
    CAPTURE(std::string(method));
    const std::vector<json> answers = json_lines(
        run_tagsmith("localize surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml "
                     "--follow" +
                     std::string(method) + " < " + input)
            .out);
    REQUIRE(answers.size() == 2);
    CHECK(answers[0].at("status") == "ok");
    CHECK(answers[1].at("status") == "no_position");
    CHECK(answers[1].dump().find("has the same picture") != std::string::npos);
  }
}

TEST_CASE("a live photo that cannot be read is a finding although the other one shows the place") {
  const TemporaryFolder folder;
  const std::string input = file_with(
      folder.path() / "input",
      R"({"id": "1", "left": "surveys/corridor/photos/corridor_05_left.jpg", "right": "nope.jpg"})");
  for (const char* method : {"", " --unsurveyed"}) {
    const ProgramOutput output = run_tagsmith(
        "localize surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --follow" +
        std::string(method) + " < " + input);
    CHECK(json_lines(output.out).front().at("status") == "ok");
    CHECK(output.exit_code == 1);
  }
}

TEST_CASE("the help has an example") {
  const ProgramOutput output = run_tagsmith("localize --help");
  CHECK(output.exit_code == 0);
  CHECK(output.out.find("tagsmith localize surveys/corridor/survey.yaml --rig") !=
        std::string::npos);
}

TEST_CASE("a tag that the run shows to hang elsewhere is set aside in all rows") {
  const TemporaryFolder folder;
  std::string survey = contents("surveys/corridor/survey.yaml");
  survey.insert(survey.find("\ncode:"),
                "\nplaced:\n  - { tag: 001L, side: left, p: [1.9, 0.8, 0.43], "
                "digits: \"01900080040\" }\n");
  const std::string file = file_with(folder.path() / "survey.yaml", survey);
  const std::string command =
      "localize '" + file + "' --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv";
  const ProgramOutput words = run_tagsmith(command);
  CHECK(words.exit_code == 0);
  CHECK(words.err.find("set aside in 1 row: 001L hangs 30 mm from its surveyed place") !=
        std::string::npos);
  const std::vector<json> lines = json_lines(run_tagsmith(command + " --json").out);
  REQUIRE(lines.back()["summary"].contains("set_aside"));
  const json& aside = lines.back()["summary"]["set_aside"];
  REQUIRE(aside.size() == 1);
  CHECK(aside[0]["tag"] == "001L");
  CHECK(aside[0]["rule"] == "moved");
  CHECK(aside[0]["rows"] == 1);
  for (const json& line : lines) {
    if (!line.contains("id")) continue;
    CHECK(std::ranges::find(line["tags"], "001L") == line["tags"].end());
    CHECK(line["error_plane"].get<double>() < 0.002);
  }
}

TEST_CASE("live measurements set a tag aside once those before show where it hangs") {
  const TemporaryFolder folder;
  std::string survey = contents("surveys/corridor/survey.yaml");
  survey.insert(survey.find("\ncode:"),
                "\nplaced:\n  - { tag: 001R, side: right, p: [0.0, 1.143, 0.48], "
                "digits: \"00000114040\" }\n");
  const std::string file = file_with(folder.path() / "survey.yaml", survey);
  std::string input;
  for (const int row : {1, 2, 3, 4, 2, 3}) {
    for (const char* side : {"left", "right"}) {
      input += side == std::string("left") ? fmt::format("{{\"id\": \"{}\", ", row) : ", ";
      input +=
          fmt::format("\"{0}\": \"surveys/corridor/photos/corridor_{1:02}_{0}.jpg\"", side, row);
    }
    input += "}\n";
  }
  const ProgramOutput output =
      run_tagsmith("localize '" + file + "' --rig surveys/corridor/rig.yaml --follow < '" +
                   file_with(folder.path() / "input", input) + "'");
  CHECK(output.err.find("set aside from here on: 001R hangs") != std::string::npos);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 6);
  // Nothing tells which of two tags is off, or whether the two photos were taken together.
  CHECK(lines[1].at("status") == "no_position");
  CHECK(lines[2].at("status") == "no_position");
  for (const std::size_t later : {3U, 4U, 5U}) {
    CHECK(lines[later].at("status") == "ok");
    const auto says_it = [](const json& note) {
      return note.get<std::string>().find("001R hangs") != std::string::npos;
    };
    CHECK(std::ranges::count_if(lines[later].at("notes"), says_it) == (later == 3 ? 1 : 0));
    CHECK(std::ranges::find(lines[later].at("tags"), "001R") == lines[later].at("tags").end());
  }
  CHECK(std::abs(lines[4].at("position")[0].get<double>() - 1.0) < 0.003);
  CHECK(std::abs(lines[4].at("position")[1].get<double>() - 0.0) < 0.003);
}

TEST_CASE("photos of another drive than the survey's are told as such") {
  const auto summary_of = [](const std::string& survey) {
    const ProgramOutput output =
        run_tagsmith("localize --json surveys/" + survey +
                     "/survey.yaml --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv");
    return json_lines(output.out).back().at("summary");
  };
  const json other = summary_of("curved");
  CHECK(other.at("located") == 0);
  CHECK(other.contains("another_drive"));
  CHECK_FALSE(summary_of("corridor").contains("another_drive"));
}

TEST_CASE("no row of a run that contradicts its rig is confirmed") {
  // A camera 10 mm from its place, which is stated to 1 mm: rows are located.
  const TemporaryFolder folder;
  std::string rig = contents("surveys/corridor/rig.yaml");
  const std::string left = "side: left, blur_px: 0.7, sigma: 0 }";
  rig.replace(rig.find(left), left.size(),
              "side: left, position: [0, 0.01, 0], "
              "sigma: { position: 0.001, angle: 0.01, focal: 0, center: 0 } }");
  const std::string file = file_with(folder.path() / "rig.yaml", rig);
  const std::string command = "localize surveys/corridor/survey.yaml --rig '" + file +
                              "' --run surveys/corridor/run.csv --json";
  const ProgramOutput output = run_tagsmith(command);
  CHECK(output.exit_code == 1);
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.back()["summary"].contains("rig_suspicion"));
  CHECK(lines.back()["summary"]["located"].get<int>() >= 5);
  CHECK(lines.back()["summary"]["confirmed"] == 0);
  for (const json& line : std::span(lines).first(lines.size() - 1)) {
    if (line["status"] != "ok") continue;
    CHECK(line["confirmations"] == 0);
    CHECK(line["notes"].dump().find("do not rely on this position: the rig is in doubt") !=
          std::string::npos);
  }
  const json summary = json_lines(run_tagsmith(command + " --confirmed").out).back()["summary"];
  CHECK(summary["located"] == 0);
}

TEST_CASE("plates that all lean otherwise than surveyed are told with what to write") {
  const TemporaryFolder folder;
  const std::string file = file_with(folder.path() / "survey.yaml", tilted_corridor(1.5));
  const std::string rest =
      " '" + file + "' --rig surveys/corridor/rig.yaml --run surveys/corridor/run.csv";
  const std::string words = "plates of both walls that lean back by 1.50 ";
  const std::string remedy =
      "; if so, add -1.5 degrees to `tags.tilt`, and to each `tilt` that tags of `placed` state";
  const ProgramOutput located = run_tagsmith("localize --json" + rest);
  CHECK(located.exit_code == 1);
  const json suspicion = json_lines(located.out).back()["summary"]["rig_suspicion"];
  REQUIRE(suspicion["suspects"].size() == 1);
  CHECK(suspicion["suspects"][0]["camera"].is_null());
  CHECK(suspicion["suspects"][0]["parameter"] == "plate_tilt");
  CHECK(suspicion["suspects"][0]["stated"] == 0);
  CHECK(std::abs(suspicion["suspects"][0]["expected"].get<double>() + 1.5) < 0.05);
  CHECK(suspicion["text"].get<std::string>().starts_with(words));
  CHECK(suspicion["text"].get<std::string>().find(remedy) != std::string::npos);
  const ProgramOutput verified = run_tagsmith("verify" + rest);
  CHECK(verified.exit_code == 0);
  CHECK(verified.err.find(words) != std::string::npos);
  CHECK(verified.out.find("not judged") == std::string::npos);
  CHECK(verified.out.find("where tags hang, against the survey") != std::string::npos);
}

TEST_CASE("a rig that all rows contradict in the same way is told with the value they expect") {
  const TemporaryFolder folder;
  std::string rig = contents("surveys/corridor/rig.yaml");
  const std::string right = "alpha: 35, side: left";
  rig.replace(rig.find(right), right.size(), "alpha: 40, side: left");
  const std::string file = file_with(folder.path() / "rig.yaml", rig);
  const std::string command =
      "localize surveys/corridor/survey.yaml --rig '" + file + "' --run surveys/corridor/run.csv";
  const ProgramOutput words = run_tagsmith(command);
  CHECK(words.exit_code == 1);
  CHECK(std::regex_search(words.out, std::regex("left: alpha 3(4\\.99|5\\.0)")));
  CHECK(words.out.find("in place of 40.00") != std::string::npos);
  const json summary = json_lines(run_tagsmith(command + " --json").out).back()["summary"];
  CHECK(summary["rig_suspicion"]["rows"] == 10);
  CHECK(summary["rig_suspicion"]["rows_as_stated"] < 10);
  const json& suspects = summary["rig_suspicion"]["suspects"];
  const auto left = std::ranges::find_if(
      suspects, [](const json& suspect) { return suspect["camera"] == "left"; });
  REQUIRE(left != suspects.end());
  CHECK((*left)["parameter"] == "yaw");
  CHECK((*left)["stated"].get<double>() == doctest::Approx(50));
  CHECK(std::abs((*left)["expected"].get<double>() - 55) < 0.05);
}
