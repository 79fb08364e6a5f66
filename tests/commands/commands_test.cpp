// SPDX-License-Identifier: Apache-2.0
#include "decoder/cli/commands.hpp"

#include <algorithm>
#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>
#include <doctest/doctest.h>

#include "tests/support/program.hpp"

using namespace tagsmith;
using namespace tagsmith::test;

TEST_CASE("every option of every command takes one value, and what follows is no other") {
  CLI::App app;
  int options = 0;
  for (const Command& command : add_commands(app)) {
    for (const CLI::Option* option : command.app->get_options()) {
      if (!option->nonpositional() || option->get_items_expected_min() == 0) continue;  // a flag
      CAPTURE(command.app->get_name());
      CAPTURE(option->get_name());
      CHECK_FALSE(option->get_allow_extra_args());
      CHECK(option->get_items_expected_min() == 1);
      ++options;
    }
  }
  CHECK(options > 60);
}

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
