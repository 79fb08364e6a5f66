// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace tagsmith::test {
namespace {

using nlohmann::json;

const std::string kPhotos = "surveys/corridor/photos";
const std::string kSurvey = " --survey surveys/corridor/survey.yaml";

std::vector<json> json_lines(const std::string& text) {
  std::vector<json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(json::parse(line));
  return lines;
}

}  // namespace

TEST_CASE("a folder of photos is read in order, one JSON object an image") {
  const ProgramOutput output = run_tagsmith("read --json " + kPhotos);
  CHECK(output.exit_code == 0);
  CHECK(output.err == "");
  const std::vector<json> lines = json_lines(output.out);
  REQUIRE(lines.size() == 20);
  CHECK(lines[0]["image"] == kPhotos + "/corridor_01_left.jpg");
  CHECK(lines[19]["image"] == kPhotos + "/corridor_10_right.jpg");
  for (const json& line : lines) {
    CHECK(line["width"] == 1280);
    CHECK(line["height"] == 960);
    CHECK(line["tags"].size() >= 1);
    CHECK(line["time_ms"].get<double>() > 0);
    for (const json& tag : line["tags"]) {
      CHECK(tag["digits"].get<std::string>().size() == 12);
      CHECK(tag["position"][2] == 0.4);
      CHECK(tag["corners"].size() == 4);
    }
  }
}

TEST_CASE("the number of jobs changes nothing but the time") {
  const auto without_times = [](const std::string& arguments) {
    std::vector<json> lines = json_lines(run_tagsmith("read --json " + arguments).out);
    for (json& line : lines) line.erase("time_ms");
    return lines;
  };
  const std::string photos = kPhotos + "/corridor_01_*.jpg " + kPhotos + "/corridor_02_*.jpg";
  CHECK(without_times("--jobs 1 " + photos) == without_times("--jobs 4 " + photos));
}

TEST_CASE("a list of files comes from standard input") {
  const ProgramOutput output = run_shell("ls " + kPhotos + "/corridor_0[34]_left.jpg | " +
                                         "\"$TAGSMITH_PROGRAM\" read --json -");
  CHECK(output.exit_code == 0);
  CHECK(json_lines(output.out).size() == 2);
}

TEST_CASE("an unreadable file is told and the others are read") {
  const ProgramOutput output =
      run_tagsmith("read --json main.cpp no-such.jpg " + kPhotos + "/corridor_01_left.jpg");
  CHECK(output.exit_code == 2);
  CHECK(json_lines(output.out).size() == 1);
  CHECK(output.err.find("tagsmith read: main.cpp: is no image") != std::string::npos);
  CHECK(output.err.find("tagsmith read: no-such.jpg: no such file") != std::string::npos);
}

TEST_CASE("an image without a tag gives exit code 1") {
  const TemporaryFolder folder;
  const std::string image = (folder.path() / "white.pgm").string();
  std::ofstream(image, std::ios::binary) << "P5 200 100 255\n" << std::string(20000, '\xff');
  const ProgramOutput output = run_tagsmith("read --json " + image);
  CHECK(output.exit_code == 1);
  CHECK(json_lines(output.out).at(0)["tags"].empty());
  CHECK(run_tagsmith("read " + image).out == image + ": 0 tags\n");
}

TEST_CASE("a survey is the code book: other codes are not returned, its own are named") {
  const std::string photo = kPhotos + "/corridor_01_left.jpg";
  const ProgramOutput named = run_tagsmith("read " + photo + kSurvey);
  CHECK(named.exit_code == 0);
  CHECK(named.out.find("000L of corridor") != std::string::npos);
  const ProgramOutput strange =
      run_tagsmith("read --json " + photo + " --survey surveys/curved/survey.yaml");
  CHECK(strange.exit_code == 1);
  CHECK(json_lines(strange.out).at(0)["tags"].empty());
}

TEST_CASE("the check digit that is asked for must hold") {
  const std::string photo = kPhotos + "/corridor_01_left.jpg";
  CHECK(run_tagsmith("read --check sum10 " + photo).exit_code == 0);
  CHECK(run_tagsmith("read --check gs1 " + photo).exit_code == 1);
}

TEST_CASE("the paper's pipeline is one of the readers") {
  const ProgramOutput output =
      run_tagsmith("read --json --reader paper " + kPhotos + "/corridor_01_left.jpg");
  CHECK(output.exit_code == 0);
  CHECK(json_lines(output.out).at(0)["tags"].at(0)["method"] == "paper");
}

TEST_CASE("wrong use gives exit code 2 and writes nothing to standard output") {
  for (const char* arguments :
       {"read", "read --check ean13 a.jpg", "read --reader other a.jpg", "read --jobs 0 a.jpg",
        "read --survey no-such.yaml surveys/corridor/photos", "read docs", "read -"}) {
    CAPTURE(arguments);
    const ProgramOutput output = run_tagsmith(arguments);
    CHECK(output.exit_code == 2);
    CHECK(output.out == "");
    CHECK(output.err != "");
  }
}

TEST_CASE("results that cannot be written are an error") {
  const ProgramOutput output =
      run_shell("\"$TAGSMITH_PROGRAM\" read " + kPhotos + "/corridor_01_left.jpg > /dev/full");
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("standard output cannot be written") != std::string::npos);
}

TEST_CASE("the help has an example") {
  const ProgramOutput output = run_tagsmith("read --help");
  CHECK(output.exit_code == 0);
  CHECK(output.out.find("tagsmith read surveys/corridor/photos") != std::string::npos);
}

}  // namespace tagsmith::test
