// SPDX-License-Identifier: Apache-2.0
// Files that are no photos, beside photos and by name.
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tagsmith/base/file.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"
#include "tests/support/turned_heic.hpp"

namespace fs = std::filesystem;
using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
using nlohmann::json;

namespace {

const std::string kPhoto = "surveys/corridor/photos/corridor_01_left.jpg";

// Pipes that nobody writes must not be waited for.
ProgramOutput run_in_time(const std::string& arguments) {
  return run_shell("timeout 100 \"$TAGSMITH_PROGRAM\" " + arguments);
}

std::string mp4() {
  return std::string(
      "\0\0\0\x18"
      "ftypmp42\0\0\0\0mp42isom",
      24);
}

// The photo as HEIC, in the folder.
std::string heic_of(const std::string& photo, const TemporaryFolder& folder) {
  REQUIRE_MESSAGE(has_program("heif-enc"), "heif-enc is missing: install libheif-examples");
  const std::string heic = (folder.path() / "photo.heic").string();
  REQUIRE(run_shell("heif-enc -q 70 -o '" + heic + "' '" + photo + "'").exit_code == 0);
  return heic;
}

}  // namespace

TEST_CASE("what a folder holds besides photos is counted by kind, and no pipe is waited for") {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  fs::copy_file(kPhoto, at + "/a.jpg");
  REQUIRE(::mkfifo((at + "/b.jpg").c_str(), 0600) == 0);
  REQUIRE(write_file(at + "/c.MP4", mp4()));
  REQUIRE(write_file(at + "/d.mp4", mp4()));
  REQUIRE(write_file(at + "/notes", "x"));
  fs::create_directory(at + "/deeper");

  const ProgramOutput read = run_in_time("read --json '" + at + "'");
  CHECK(read.exit_code == 0);
  CHECK(json_lines(read.out).size() == 1);
  for (const char* kind :
       {"2 mp4", "1 pipe", "1 folder", "1 file without extension", "ffmpeg -i"}) {
    CHECK_MESSAGE(read.err.find(kind) != std::string::npos, read.err);
  }

  const ProgramOutput verify =
      run_in_time("verify --json surveys/corridor/survey.yaml '" + at + "'");
  CHECK(verify.exit_code == 0);
  CHECK(json_lines(verify.out).back()["summary"]["skipped"] ==
        json{{"mp4", 2}, {"pipe", 1}, {"folder", 1}, {"file without extension", 1}});
  CHECK(verify.err.find("2 mp4") != std::string::npos);

  fs::remove(at + "/a.jpg");
  const ProgramOutput none = run_in_time("read '" + at + "'");
  CHECK(none.exit_code == 2);
  CHECK(none.err.find("2 mp4") != std::string::npos);
}

TEST_CASE("a pipe or a video given by name is refused with what to do") {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  REQUIRE(::mkfifo((at + "/b.jpg").c_str(), 0600) == 0);
  REQUIRE(write_file(at + "/c.mp4", mp4()));
  for (const std::string& command :
       {std::string("read "), std::string("verify surveys/corridor/survey.yaml ")}) {
    CAPTURE(command);
    const ProgramOutput pipe = run_in_time(command + "'" + at + "/b.jpg' " + kPhoto);
    CHECK(pipe.exit_code == 2);
    CHECK_MESSAGE(pipe.err.find("is a pipe") != std::string::npos, pipe.err);
    CHECK(pipe.out.find("corridor_01_left") != std::string::npos);  // the others are read
    const ProgramOutput video = run_in_time(command + "'" + at + "/c.mp4'");
    CHECK(video.exit_code == 2);
    CHECK_MESSAGE(video.err.find("ffmpeg -i") != std::string::npos, video.err);
  }
  REQUIRE(write_file(at + "/run.csv", "id,left,right,d\n1,b.jpg,,1.0\n"));
  const ProgramOutput run = run_in_time(
      "localize surveys/corridor/survey.yaml --rig surveys/corridor/rig.yaml --json --run '" + at +
      "/run.csv'");
  CHECK(run.exit_code == 1);
  CHECK(json_lines(run.out).front()["reason"].get<std::string>().find("is a pipe") !=
        std::string::npos);
}

TEST_CASE("a run comes through a pipe that is written") {
  const ProgramOutput output = run_shell(
      "cd surveys/corridor && cat survey.yaml | timeout 100 \"$TAGSMITH_PROGRAM\" validate "
      "/dev/stdin");
  CHECK_MESSAGE(output.exit_code == 0, output.err);
}

TEST_CASE("HEIC photos are read as JPEGs are, whichever way they were taken") {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  REQUIRE(write_file(at + "/side.heic",
                     turned_heic(read_file(heic_of(kPhoto, folder)).value(), 3, std::nullopt)));
  const std::vector<json> lines =
      json_lines(run_tagsmith("read --json " + kPhoto + " '" + at + "'").out);
  REQUIRE(lines.size() == 3);
  for (const json& line : lines) {
    CHECK(line["width"] == 1280);  // pixels as stored
    REQUIRE(line["tags"].size() == lines[0]["tags"].size());
    CHECK(line["tags"][0]["digits"] == lines[0]["tags"][0]["digits"]);
    for (std::size_t i = 0; i < 4; ++i) {
      const double moved = line["tags"][0]["corners"][i][0].get<double>() -
                           lines[0]["tags"][0]["corners"][i][0].get<double>();
      CHECK(std::abs(moved) < 0.3);
    }
  }
  const ProgramOutput verify = run_tagsmith("verify --json surveys/corridor/survey.yaml '" + at +
                                            "/side.heic' --annotate '" + at + "/copies'");
  CHECK(json_lines(verify.out).front()["orientation"] == 6);
  const ProgramOutput copy = run_tagsmith("read --json '" + at + "/copies'");
  CHECK(json_lines(copy.out).front()["width"] == 960);  // upright
}

TEST_CASE("HEIC files that are cut short or damaged are refused with a message") {
  const TemporaryFolder folder;
  // A small picture, which the sanitizers decode in time.
  const std::string drawing = (folder.path() / "drawing.svg").string();
  REQUIRE(write_file(drawing,
                     "<svg xmlns='http://www.w3.org/2000/svg' width='160' height='120'>"
                     "<rect width='160' height='120' fill='#ccc'/>"
                     "<path d='M10 110 L150 10 M60 5 L90 115' stroke='#111'/></svg>"));
  REQUIRE(run_shell("rsvg-convert -o '" + drawing + ".png' '" + drawing + "'").exit_code == 0);
  const std::string heic = read_file(heic_of(drawing + ".png", folder)).value();
  REQUIRE(heic.size() > 1000);
  const std::string file = (folder.path() / "bad.heic").string();
  for (const std::size_t size :
       {std::size_t{12}, std::size_t{24}, std::size_t{300}, heic.size() / 2, heic.size() - 100}) {
    CAPTURE(size);
    REQUIRE(write_file(file, heic.substr(0, size)));
    const ProgramOutput output = run_in_time("read '" + file + "'");
    CHECK(output.exit_code == 2);
    CHECK(output.err.find("bad.heic: ") != std::string::npos);
  }
  // Every byte of the boxes in turn: no crash, and no time without end.
  for (std::size_t at = 4; at < 500; at += 7) {
    CAPTURE(at);
    std::string changed = heic;
    changed[at] = static_cast<char>(~static_cast<unsigned char>(changed[at]));
    REQUIRE(write_file((folder.path() / ("x" + std::to_string(at) + ".heic")).string(), changed));
  }
  CHECK(run_in_time("read '" + folder.path().string() + "'/x*.heic").exit_code == 2);
  // A picture that says it has 30000 x 30000 pixels.
  std::string huge = heic;
  const std::size_t size = huge.find("ispe");
  REQUIRE(size != std::string::npos);
  huge.replace(size + 8, 8, std::string("\0\0\x75\x30\0\0\x75\x30", 8));
  REQUIRE(write_file(file, huge));
  const ProgramOutput output = run_in_time("read '" + file + "'");
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("too many pixels") != std::string::npos);
}
