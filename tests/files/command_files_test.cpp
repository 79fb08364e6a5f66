// SPDX-License-Identifier: Apache-2.0
// No command writes over what it reads, nor over another of its outputs.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;
using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

constexpr const char* kCalibration =
    "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 960\n"
    "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
    "   data: [ 1600., 0., 639.5, 0., 1600., 479.5, 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
    "   data: [ 0., 0., 0., 0., 0. ]\n";

// A surveyor's folder: everything that commands read.
class Desk {
 public:
  Desk() {
    fs::copy_file("surveys/corridor/survey.yaml", at("survey.yaml"));
    fs::copy_file("templates/tag-400x300.yaml", at("tag-400x300.yaml"));
    fs::copy_file("surveys/corridor/photos/corridor_01_left.jpg", at("left.jpg"));
    write("left.yml", kCalibration);
    write("rig.yaml",
          "rig: desk\ncameras:\n  left: { calibration: left.yml, alpha: 35, side: left }\n"
          "ranges:\n  d: { wall: left, min: 0.25, max: 5.0, sigma: 0.01 }\n"
          "vehicle: { height: 0.24 }\n");
    write("run.csv", "id,left,d,time,truth_x,truth_y,truth_z\na,left.jpg,1.0,1,1.0,-0.5,0.24\n");
    write("list.txt", "000L\n");
    write("manifest.json", "{}\n");
    write("lines.jsonl", "{\"file\":\"left.jpg\",\"tags\":[],\"findings\":[\"no tag\"]}\n");
  }

  fs::path at(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& text) const {
    REQUIRE(write_file(at(name), text));
  }
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      all[entry.path().string()] = entry.is_regular_file() ? contents(entry.path()) : "";
    }
    return all;
  }
  ProgramOutput run(const std::string& arguments) const {
    return run_shell("cd '" + folder_.path().string() + "' && \"$TAGSMITH_PROGRAM\" " + arguments);
  }

 private:
  TemporaryFolder folder_;
};

struct Collision {
  std::string arguments;
  std::string roles[2];     // both are named
  std::string link_from{};  // this name, where given, is a link to the next
  std::string link_to{};
};

const std::vector<Collision> kCollisions{
    {"export survey.yaml --format csv -o survey.yaml", {"--output", "the survey"}},
    {"export survey.yaml --format csv -o tag-400x300.yaml", {"--output", "template"}},
    {"export survey.yaml -o out.csv", {"--output", "the survey"}, "out.csv", "survey.yaml"},
    {"draw survey.yaml --rig rig.yaml -o d.pdf", {"--output", "calibration"}, "d.pdf", "left.yml"},
    {"draw survey.yaml --rig rig.yaml -o d.svg", {"--output", "the rig"}, "d-2.svg", "rig.yaml"},
    {"plan survey.yaml --rig rig.yaml -o .", {"--output", "the rig"}, "plan.json", "rig.yaml"},
    {"plan survey.yaml --rig rig.yaml --optimise -o .", {"--output", "the survey"}},
    {"print survey.yaml -o .", {"--output", "the survey"}, "000L.pdf", "survey.yaml"},
    {"print survey.yaml --only manifest.csv -o .",
     {"--output", "--only"},
     "manifest.csv",
     "list.txt"},
    {"simulate survey.yaml --rig rig.yaml --run run.csv --force -o .", {"--output", "the run"}},
    {"simulate survey.yaml --rig rig.yaml --run run.csv --force -o .",
     {"--output", "photo"},
     "truth.json",
     "left.jpg"},
    {"simulate survey.yaml --rig rig.yaml --run run.csv --force -o .",
     {"--output", "the rig"},
     "truth.json",
     "rig.yaml"},
    {"localize survey.yaml --rig rig.yaml --run run.csv -o run.csv", {"--csv", "the run"}},
    {"localize survey.yaml --rig rig.yaml --run run.csv --tum ./rig.yaml", {"--tum", "the rig"}},
    {"localize survey.yaml --rig rig.yaml --run run.csv --drawing a.png",
     {"--drawing", "photo"},
     "a.png",
     "left.jpg"},
    {"localize survey.yaml --rig rig.yaml --run run.csv --residuals .",
     {"--residuals", "calibration"},
     "001-a.svg",
     "left.yml"},
    {"localize survey.yaml --rig rig.yaml --run run.csv -o both --tum ./both", {"--csv", "--tum"}},
    {"localize survey.yaml --rig rig.yaml --run run.csv -o new/a --tum new/../new/a",
     {"--csv", "--tum"}},
    {"verify survey.yaml left.jpg --html survey.yaml", {"--html", "the survey"}},
    {"verify survey.yaml left.jpg --csv left.jpg", {"--csv", "the file"}},
    {"verify survey.yaml left.jpg --csv manifest.json", {"--csv", "manifest"}},
    {"verify survey.yaml left.jpg --rig rig.yaml --run run.csv --pdf run.csv", {"--pdf", "run"}},
    {"verify survey.yaml left.jpg --resume lines.jsonl --csv lines.jsonl", {"--csv", "--resume"}},
    {"verify survey.yaml - --csv list.txt < list.txt", {"--csv", "list of files"}},
    {"verify survey.yaml left.jpg --csv r --html r", {"--csv", "--html"}},
    {"verify survey.yaml left.jpg --ledger left.jpg", {"--ledger", "the file"}},
    {"verify survey.yaml left.jpg --ledger a --html a", {"--ledger", "--html"}},
    {"verify survey.yaml left.jpg --ledger a --csv a-journal", {"journal", "--csv"}},
    {"report survey.yaml lines.jsonl --ledger lines.jsonl", {"--ledger", "the lines"}},
    {"report survey.yaml lines.jsonl --ledger survey.yaml", {"--ledger", "the survey"}},
    {"report survey.yaml lines.jsonl --html lines.jsonl", {"--html", "the lines"}},
    {"report survey.yaml lines.jsonl --rig rig.yaml --pdf left.yml", {"--pdf", "calibration"}},
    {"read left.jpg --explain .", {"--explain", "the picture"}, "left.explained.png", "left.jpg"},
    {"read left.jpg --survey survey.yaml --explain .",
     {"--explain", "the survey"},
     "left.explained.png",
     "survey.yaml"},
};

}  // namespace

TEST_CASE("an output that is an input, by its name or a link, is refused and nothing is written") {
  for (const Collision& collision : kCollisions) {
    for (const bool hard : {false, true}) {
      if (hard && collision.link_from.empty()) continue;
      CAPTURE(collision.arguments);
      CAPTURE(collision.link_from);
      CAPTURE(hard);
      const Desk desk;
      if (!collision.link_from.empty()) {
        if (hard) {
          fs::create_hard_link(desk.at(collision.link_to), desk.at(collision.link_from));
        } else {
          fs::create_symlink(collision.link_to, desk.at(collision.link_from));
        }
      }
      const auto before = desk.files();
      const ProgramOutput output = desk.run(collision.arguments);
      CHECK(output.exit_code == 2);
      CHECK(output.out == "");
      for (const std::string& role : collision.roles) {
        CHECK_MESSAGE(output.err.find(role) != std::string::npos, output.err);
      }
      CHECK(desk.files() == before);
    }
  }
}

TEST_CASE("photos that the lines of a report name are spared") {
  const Desk desk;
  const std::string lines = desk.run("verify survey.yaml left.jpg --json").out;
  std::string faulty = lines.substr(0, lines.find('\n') + 1);
  const auto status = faulty.find("\"status\":\"ok\"");
  REQUIRE(status != std::string::npos);
  faulty.replace(status, 13, "\"status\":\"unreadable\",\"message\":\"dirt\"");
  desk.write("lines.jsonl", faulty);
  const auto before = desk.files();
  const ProgramOutput output = desk.run("report survey.yaml lines.jsonl --html left.jpg");
  CHECK(output.exit_code == 2);
  CHECK_MESSAGE(output.err.find("photo of the lines") != std::string::npos, output.err);
  CHECK(desk.files() == before);
}

TEST_CASE("crops and copies of photos spare the files that are verified") {
  const Desk desk;
  REQUIRE(desk.run("verify survey.yaml left.jpg --annotate .").exit_code == 0);
  std::string copy;
  for (const auto& [path, bytes] : desk.files()) {
    if (path.find("left-") != std::string::npos) copy = fs::path(path).filename().string();
  }
  REQUIRE(!copy.empty());
  const auto before = desk.files();
  const ProgramOutput output = desk.run("verify survey.yaml left.jpg " + copy + " --annotate .");
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("--annotate") != std::string::npos);
  CHECK(contents(desk.at(copy)) == before.at(desk.at(copy).string()));
}

TEST_CASE("an output that cannot be written is told before the work") {
  const Desk desk;
  desk.write("in-the-way", "");
  fs::create_directory(desk.at("folder"));
  const std::string run = "localize survey.yaml --rig rig.yaml --run run.csv ";
  for (const std::string arguments :
       {"verify survey.yaml left.jpg --html in-the-way/r.html",
        "verify survey.yaml left.jpg --pdf folder",
        "verify survey.yaml left.jpg --crops in-the-way",
        "report survey.yaml lines.jsonl --csv folder", "report survey.yaml lines.jsonl --csv -",
        "read left.jpg --explain in-the-way/deeper"}) {
    CAPTURE(arguments);
    const ProgramOutput output = desk.run(arguments);
    CHECK(output.exit_code == 2);
    CHECK(output.out == "");  // no photo was read
  }
  for (const std::string option :
       {"--drawing in-the-way/a.pdf", "--csv folder", "--residuals in-the-way"}) {
    CAPTURE(option);
    // A run whose photo is missing would tell so, had it been looked for.
    desk.write("run.csv", "id,left,d\na,missing.jpg,1.0\n");
    const ProgramOutput output = desk.run(run + option);
    CHECK(output.exit_code == 2);
    CHECK(output.out == "");
  }
}

TEST_CASE("a survey is mended in place, through a link too") {
  const Desk desk;
  std::string text = contents(desk.at("survey.yaml"));
  const auto key = text.find("spacing:");
  REQUIRE(key != std::string::npos);
  desk.write("survey.yaml", text.replace(key, 8, "spacin:"));
  fs::create_symlink("survey.yaml", desk.at("link.yaml"));
  CHECK(desk.run("validate --fix link.yaml").exit_code == 0);
  CHECK(fs::is_symlink(desk.at("link.yaml")));
  CHECK(contents(desk.at("survey.yaml")).find("spacing:") != std::string::npos);
}

TEST_CASE("0 jobs are as many as there are cores, in every command") {
  const Desk desk;
  for (const std::string arguments :
       {"read left.jpg", "verify survey.yaml left.jpg", "print survey.yaml -o p --tags 000L",
        "plan survey.yaml --rig rig.yaml --to 1",
        "localize survey.yaml --rig rig.yaml --run run.csv",
        "simulate survey.yaml --rig rig.yaml --run run.csv -o s"}) {
    CAPTURE(arguments);
    const ProgramOutput output = desk.run(arguments + " --jobs 0");
    CHECK_MESSAGE(output.exit_code < 2, output.err);
    CHECK(desk.run(arguments + " --jobs -1").exit_code == 2);
  }
}
