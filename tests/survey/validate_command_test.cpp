// SPDX-License-Identifier: Apache-2.0
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::test;

TEST_CASE("validate passes the shipped surveys and says so on standard error only") {
  const ProgramOutput output = run_tagsmith(
      "validate surveys/corridor/survey.yaml surveys/curved/survey.yaml "
      "--rig surveys/corridor/rig.yaml --rig surveys/curved/rig.yaml "
      "--template templates/tag-400x300.yaml");
  CHECK(output.exit_code == 0);
  CHECK(output.out.empty());
  CHECK(output.err == "5 files: 0 errors, 0 warnings\n");
}

TEST_CASE("validate reports every error of several files in one run") {
  const TemporaryFolder folder;
  const std::string survey = write_text(
      folder.path() / "s.yaml",
      replaced(replaced(right_survey(), "width: 4.0", "width: 4,0"), "spacing:", "spaceing:"));
  const std::string rig =
      write_text(folder.path() / "r.yaml", replaced(right_rig(), "alpha:", "alfa:"));
  const ProgramOutput output = run_tagsmith("validate '" + survey + "' --rig '" + rig + "'");
  CHECK(output.exit_code == 1);
  CHECK(output.out.find(
            "s.yaml:4:10: error: tunnel.width is `4,0`, expected a finite number "
            "[decimal-comma]\n    4 |   width: 4,0\n      |          ^~~\n    write 4.0") !=
        std::string::npos);
  CHECK(output.out.find("s.yaml:15:3: error: unknown key `spaceing` in tags") != std::string::npos);
  CHECK(output.out.find("r.yaml:7:5: error: unknown key `alfa`") != std::string::npos);
  CHECK(output.err.find("2 files: ") == 0);
}

TEST_CASE("validate --json prints the documented fields, one object a line") {
  const TemporaryFolder folder;
  const std::string survey = write_text(
      folder.path() / "s.yaml", replaced(right_survey(), "resolution: 0.01", "resolution: 0.05"));
  const ProgramOutput output = run_tagsmith("validate --json '" + survey + "'");
  CHECK(output.exit_code == 0);  // a warning is no error
  std::istringstream lines(output.out);
  std::string line;
  int count = 0;
  while (std::getline(lines, line)) {
    const auto finding = nlohmann::json::parse(line);
    CHECK(finding["file"] == survey);
    CHECK(finding["line"] == 19);
    CHECK(finding["column"].is_number_integer());
    CHECK(finding["severity"] == "warning");
    CHECK(finding["code"] == "coarse-code");
    CHECK(finding["message"].is_string());
    CHECK(finding["hint"].is_string());
    ++count;
  }
  CHECK(count == 1);
}

TEST_CASE("validate checks surveys against each other") {
  const ProgramOutput output =
      run_tagsmith("validate surveys/corridor/survey.yaml surveys/corridor-table4/survey.yaml");
  CHECK(output.exit_code == 1);
  CHECK(output.out.find("[code-collision]") != std::string::npos);
}

TEST_CASE("validate exits with 2 when a file cannot be read, and still reports the others") {
  const TemporaryFolder folder;
  const std::string survey = write_text(folder.path() / "s.yaml", "survey: x\n");
  const ProgramOutput output =
      run_tagsmith("validate '" + survey + "' '" + (folder.path() / "absent.yaml").string() + "'");
  CHECK(output.exit_code == 2);
  CHECK(output.out.find("[missing-key]") != std::string::npos);
  CHECK(output.err.find("absent.yaml: no such file") != std::string::npos);
  CHECK(run_tagsmith("validate '" + folder.path().string() + "'").exit_code == 2);
  CHECK(run_tagsmith("validate").exit_code == 2);
  CHECK(run_tagsmith("validate --nonsense").exit_code == 2);
}

TEST_CASE("validate --help shows an example") {
  const ProgramOutput output = run_tagsmith("validate --help");
  CHECK(output.exit_code == 0);
  CHECK(output.out.find("tagsmith validate surveys/corridor/survey.yaml") != std::string::npos);
}
