// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/commands.hpp"

#include <algorithm>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

TEST_CASE("photos behind --survey are photos") {
  const std::string photo = "surveys/corridor/photos/corridor_01_left.jpg";
  const ProgramOutput output =
      run_tagsmith("read --json --survey surveys/corridor/survey.yaml " + photo + " " + photo);
  CHECK(output.exit_code == 0);
  CHECK(std::ranges::count(output.out, '\n') == 2);
}

TEST_CASE("a repeatable option may be given again") {
  const ProgramOutput output = run_tagsmith(
      "validate --rig surveys/corridor/rig.yaml --rig surveys/curved/rig.yaml "
      "surveys/corridor/survey.yaml");
  CHECK(output.exit_code == 0);
  CHECK_MESSAGE(output.err.find("3 files") != std::string::npos, output.err);
}
