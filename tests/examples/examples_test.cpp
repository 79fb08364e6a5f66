// SPDX-License-Identifier: Apache-2.0
// The programs in docs/examples do what they say.
#include <doctest/doctest.h>

#include "tests/support/program.hpp"

namespace tagsmith::detail::test {

TEST_CASE("read_tag names the tag in a photo of the corridor") {
  const ProgramOutput output = run_shell(
      READ_TAG " surveys/corridor/survey.yaml surveys/corridor/photos/corridor_01_left.jpg");
  CHECK_MESSAGE(output.exit_code == 0, output.err);
  CHECK_MESSAGE(output.out.find(" is 0") == 12, output.out);
  CHECK(output.out.find("L, corner P at 1.9 ") != std::string::npos);
}

TEST_CASE("read_tag says what it cannot read") {
  CHECK(run_shell(READ_TAG).exit_code == 2);
  const ProgramOutput output = run_shell(READ_TAG " surveys/corridor/survey.yaml main.cpp");
  CHECK(output.exit_code == 2);
  CHECK(output.err.find("main.cpp: is no image") == 0);
}

}  // namespace tagsmith::detail::test
