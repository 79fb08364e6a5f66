// SPDX-License-Identifier: Apache-2.0
// Numbers made to let the program run for ever.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/program.hpp"

using namespace tagsmith::detail::test;
namespace fs = std::filesystem;

TEST_CASE("a lens that reaches to the horizon lets validate and plan end") {
  const TemporaryFolder folder;
  const fs::path rig = folder.path() / "rig.yaml";
  for (const std::string lens :
       {"model: fisheye, fx: 620, fy: 622, cx: 645, cy: 0",
        "model: fisheye, fx: 45, fy: 45, cx: 640, cy: 480",
        "fx: 620, fy: 620, cx: 640, cy: 480, distortion: [0, 0, 0, 1, 0]",
        "fx: 1.0e-9, fy: 1.0e-9, cx: 640, cy: 480", "fx: 1.0e+7, fy: 1.0e+7, cx: 640, cy: 480"}) {
    CAPTURE(lens);
    std::ofstream(rig) << "rig: horizon\ncameras:\n  left: { image_size: [1280, 960], " << lens
                       << ", alpha: 35, side: left }\nvehicle: { height: 0.24 }\n";
    for (const std::string command : {"validate surveys/corridor/survey.yaml --rig ",
                                      "plan surveys/corridor/survey.yaml --step 1 --rig "}) {
      const auto start = std::chrono::steady_clock::now();
      const ProgramOutput output =
          run_shell("timeout 60 \"$TAGSMITH_PROGRAM\" " + command + "'" + rig.string() + "'");
      CHECK(output.exit_code < 3);
      CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
    }
  }
}
