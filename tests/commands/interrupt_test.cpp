// SPDX-License-Identifier: Apache-2.0
// Long work ends at once when it is told to, and leaves nothing half.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/program.hpp"

using namespace tagsmith::detail::test;
namespace fs = std::filesystem;

namespace {

constexpr int kInterrupted = 130;  // 128 + SIGINT

std::string photos(const std::string& photo, int count) {
  std::string list;
  for (int i = 0; i < count; ++i) list += " " + photo;
  return list;
}

}  // namespace

TEST_CASE("Ctrl-C ends every long command at once and leaves nothing half") {
  const TemporaryFolder folder, photos_folder;
  const fs::path survey = folder.path() / "survey.yaml";
  std::ofstream(survey)
      << "survey: long\ntunnel: { width: 3, height: 3, centerline: { start: [0, 0, 0], heading: 0, "
         "elements: [ { line: 90000 } ] } }\ntags: { template: tag-400x300, height: 2.5, spacing: "
         "0.6, first: 1, pairs: 40000 }\ncode: { check_digit: gs1, resolution: [0.1, 0.01, 0.1], "
         "digits: [2, 7, 2], origin: [-5, 0, 0] }\n";
  const fs::path run = folder.path() / "run.csv";
  std::ofstream rows(run);
  rows << "id,left,d,truth_x,truth_y,truth_z\n";
  for (int i = 0; i < 2000; ++i) {
    const fs::path photo = photos_folder.path() / (std::to_string(i) + ".jpg");
    fs::create_symlink(fs::absolute("surveys/corridor/photos/corridor_01_left.jpg"), photo);
    rows << i << "," << photo.string() << ",0.9,1.0,0.0,0.24\n";
  }
  rows.close();
  const std::string rig = " --rig surveys/corridor/rig.yaml";
  const std::string corridor = "surveys/corridor/survey.yaml";
  const std::string photo = "surveys/corridor/photos/corridor_01_left.jpg";
  const std::string out = " -o '" + (folder.path() / "out").string() + "'";
  for (const std::string& command :
       {"validate '" + survey.string() + "'" + rig,
        "plan '" + survey.string() + "'" + rig + " --step 0.1" + out,
        "plan surveys/curved/survey.yaml --rig surveys/curved/rig.yaml --step 0.0001 --optimise" +
            out,
        "simulate " + corridor + rig + " --run '" + run.string() + "'" + out,
        "localize " + corridor + rig + " --run '" + run.string() + "'" + out,
        "verify " + corridor + photos(photo, 2500), "read" + photos(photo, 2500)}) {
    CAPTURE(command.substr(0, 60));
    const auto start = std::chrono::steady_clock::now();
    const ProgramOutput output = run_shell(
        "timeout --preserve-status -s INT 0.5 \"$TAGSMITH_PROGRAM\" " + command + " > /dev/null");
    CHECK(output.exit_code == kInterrupted);
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
    CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 2);
  }
}
