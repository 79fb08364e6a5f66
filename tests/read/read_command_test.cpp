// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "decoder/image/load.hpp"
#include "tagsmith/symbology/upca.hpp"
#include "tests/support/bar_picture.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kPhotos = "surveys/corridor/photos";
const std::string kSurvey = " --survey surveys/corridor/survey.yaml";

}  // namespace

TEST_CASE("a folder of photos is read in order, one JSON object an image") {
  const ProgramOutput output = run_tagsmith("read --json " + kPhotos);
  CHECK(output.exit_code == 0);
  CHECK(output.err == "tagsmith read: skipped, no pictures: 1 json\n");
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

TEST_CASE("the position that a tag codes is told in words by its three coordinates") {
  const ProgramOutput output = run_tagsmith("read " + kPhotos + "/corridor_02_right.jpg");
  const std::vector<json> lines =
      json_lines(run_tagsmith("read --json " + kPhotos + "/corridor_02_right.jpg").out);
  REQUIRE(lines.size() == 1);
  for (const json& tag : lines[0]["tags"]) {
    const std::string digits = tag["digits"];
    const std::regex words(digits + "  x (-?[0-9.]+) y (-?[0-9.]+) z (-?[0-9.]+) ");
    std::smatch told;
    REQUIRE(std::regex_search(output.out, told, words));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CHECK(std::stod(told[axis + 1]) == tag["position"][axis].get<double>());
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
  CHECK(output.err.find("tagsmith read: main.cpp: ") != std::string::npos);
  CHECK(output.err.find("tagsmith read: no-such.jpg: ") != std::string::npos);
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

TEST_CASE("a symbol without a frame is a tag with corners null, unless that is not wanted") {
  const TemporaryFolder folder;
  const fs::path image = folder.path() / "bars.png";
  const auto widths = elements_of(parse_digits("036000291452").value());
  const GrayImage picture = picture_of({widths.begin(), widths.end()}, {});
  REQUIRE(save_gray_image(image, picture.view()));
  const ProgramOutput output = run_tagsmith("read --json " + image.string());
  CHECK(output.exit_code == 0);
  const json tag = json_lines(output.out).at(0)["tags"].at(0);
  CHECK(tag["digits"] == "036000291452");
  CHECK(tag["corners"].is_null());
  CHECK(tag["bars"].size() == 4);
  CHECK(tag["method"] == "frameless");
  CHECK(run_tagsmith("read " + image.string()).out.find("no frame") != std::string::npos);
  CHECK(run_tagsmith("read --frameless never " + image.string()).exit_code == 1);
  CHECK(run_tagsmith("read --check sum10 " + image.string()).exit_code == 1);
}

TEST_CASE("an explanation is a picture beside the results") {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "why";
  const std::string photo = kPhotos + "/corridor_01_left.jpg";
  const std::string plain = run_tagsmith("read " + photo).out;
  const ProgramOutput output =
      run_tagsmith("read --explain " + out.string() + " " + photo + " " + photo);
  CHECK(output.exit_code == 0);
  CHECK(output.out == plain + plain);
  for (const char* name :
       {"corridor_01_left_1.explained.png", "corridor_01_left_2.explained.png"}) {
    CAPTURE(name);
    const auto image = load_gray_image(out / name);
    REQUIRE(image);
    CHECK(image->width == 1600);
    CHECK(image->height > 1200 + 250);  // the picture, the legend and a panel
  }
  CHECK(run_tagsmith("read --explain main.cpp " + photo).exit_code == 2);
}

TEST_CASE("damaged pictures of a batch are named, each by its own warning") {
  const TemporaryFolder folder;
  std::string bytes = contents(kPhotos + "/corridor_01_left.jpg");
  bytes.erase(bytes.size() / 2, 2000);
  std::string files;
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) {
    const fs::path path = folder.path() / name;
    std::ofstream(path, std::ios::binary) << bytes;
    files += " " + path.string();
  }
  const ProgramOutput output = run_tagsmith("read --json" + files);
  CHECK(json_lines(output.out).size() == 3);
  std::istringstream warnings(output.err);
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) {
    std::string line;
    REQUIRE(std::getline(warnings, line));
    CHECK_MESSAGE(line.find("tagsmith read: " + (folder.path() / name).string() + ": ") == 0, line);
  }
}

TEST_CASE("colour and 16 bits do not change what is read") {
  const TemporaryFolder folder;
  const auto photo = load_gray_image(kPhotos + "/corridor_01_left.jpg");
  REQUIRE(photo);
  const std::string size = " 1280 960 ";
  std::string color = "P6" + size + "255\n";
  std::string deep = "P5" + size + "65535\n";
  for (const std::uint8_t sample : photo->samples) {
    const char byte = static_cast<char>(sample);
    color.append({byte, byte, byte});
    deep.append({byte, byte});  // most significant byte first
  }
  const auto read = [&](const std::string& name, const std::string& bytes) {
    const fs::path path = folder.path() / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return json_lines(run_tagsmith("read --json " + path.string()).out).at(0)["tags"];
  };
  const json expected =
      json_lines(run_tagsmith("read --json " + kPhotos + "/corridor_01_left.jpg").out)
          .at(0)["tags"];
  CHECK(read("color.ppm", color) == expected);
  CHECK(read("deep.pgm", deep) == expected);
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

TEST_CASE("a mistyped command is named, with the likely one") {
  const ProgramOutput near = run_tagsmith("reed a.jpg");
  CHECK(near.exit_code == 2);
  CHECK(near.err.find("`reed`") < near.err.find("`read`"));
  CHECK(near.err.find("`read`") != std::string::npos);
  const ProgramOutput far = run_tagsmith("'' a.jpg");
  CHECK(far.exit_code == 2);
  CHECK(far.err.find("``\n") != std::string::npos);
}

TEST_CASE("the program says its version") {
  const ProgramOutput output = run_tagsmith("--version");
  CHECK(output.exit_code == 0);
  CHECK_MESSAGE(output.out.find("tagsmith 1.") == 0, output.out);
}

TEST_CASE("the program starts without OpenCV's codecs and what they draw in") {
  const auto libraries = run_shell("LD_TRACE_LOADED_OBJECTS=1 \"$TAGSMITH_PROGRAM\"");
  CHECK(libraries.out.find("libopencv_core") != std::string::npos);
  CHECK(libraries.out.find("imgcodecs") == std::string::npos);
  CHECK(libraries.out.find("libgdal") == std::string::npos);
}

TEST_CASE("results that cannot be written are an error") {
  const std::string command = "\"$TAGSMITH_PROGRAM\" read " + kPhotos + "/corridor_01_left.jpg > ";
  const ProgramOutput output = run_shell(command + "/dev/full");
  CHECK(output.exit_code == 2);
  CHECK(!output.err.empty());
  CHECK(run_shell(command + "/dev/null").exit_code == 0);
}

TEST_CASE("the help has an example") {
  const ProgramOutput output = run_tagsmith("read --help");
  CHECK(output.exit_code == 0);
  CHECK(output.out.find("tagsmith read surveys/corridor/photos") != std::string::npos);
}

}  // namespace tagsmith::detail::test
