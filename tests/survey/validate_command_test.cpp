// SPDX-License-Identifier: Apache-2.0
#include <regex>
#include <sstream>
#include <string>
#include <utility>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail::test;
using nlohmann::json;

namespace {

// The first of a file's findings by a rule; null without one.
json finding_of(const ProgramOutput& output, const std::string& file, const std::string& code) {
  for (const json& finding : json_lines(output.out)) {
    if (finding["file"] == file && finding["code"] == code) return finding;
  }
  return {};
}

}  // namespace

TEST_CASE("validate passes the shipped surveys and says so on standard error only") {
  const ProgramOutput output = run_tagsmith(
      "validate surveys/corridor/survey.yaml surveys/curved/survey.yaml "
      "--rig surveys/corridor/rig.yaml --rig surveys/curved/rig.yaml "
      "--template templates/tag-400x300.yaml");
  CHECK(output.exit_code == 0);
  CHECK(output.out.empty());
  CHECK(output.err == "5 files: 0 errors, 0 warnings\n");
}

TEST_CASE("a logo that print could not draw is an error of its template") {
  const TemporaryFolder folder;
  const std::string text = "logo: { file: logo.svg, size_mm: [40, 20] }\n" + right_template();
  const std::string file = write_text(folder.path() / "logo.yaml", text).string();
  write_text(folder.path() / "logo.svg", "no drawing");
  const ProgramOutput broken = run_tagsmith("validate --json --template " + file);
  CHECK(broken.exit_code == 1);
  CHECK(finding_of(broken, file, "no-logo")["severity"] == "error");
  write_text(folder.path() / "logo.svg",
             "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 4 2'>"
             "<rect width='4' height='2'/></svg>");
  CHECK(finding_of(run_tagsmith("validate --json --template " + file), file, "no-logo").is_null());
}

TEST_CASE("a decimal comma in braces is mended by a point") {
  const TemporaryFolder folder;
  std::string text = right_rig();
  const std::size_t at = text.find("height: 0.24");
  REQUIRE(at != std::string::npos);
  text.replace(at, 12, "height: 0,24");
  const std::string file = write_text(folder.path() / "rig.yaml", text).string();
  const json finding =
      finding_of(run_tagsmith("validate --json --rig " + file), file, "decimal-comma");
  CHECK(finding["hint"] == "write 0.24: the decimal sign is a point");
  CHECK(run_tagsmith("validate --fix --rig " + file).exit_code == 0);
  CHECK(run_tagsmith("validate --rig " + file).exit_code == 0);
}

TEST_CASE("validate --rig names the tags that no camera of the rig can see") {
  const TemporaryFolder folder;
  const std::string rig = "surveys/corridor/rig.yaml";
  const std::string high = replaced(right_survey(), "height: 1.4", "height: 2.7");
  const std::string survey = write_text(folder.path() / "s.yaml",
                                        replaced(high, "[12.0, 22.4, 1.4]", "[12.0, 22.4, 2.6]"));
  const ProgramOutput output = run_tagsmith("validate --json '" + survey + "' --rig " + rig);
  CHECK(output.exit_code == 0);
  std::istringstream lines(output.out);
  std::string line;
  int unseen = 0;
  while (std::getline(lines, line)) {
    const auto finding = parsed_json(line);
    if (finding["code"] != "unseen-tag") continue;
    ++unseen;
    const std::string message = finding["message"];
    const bool regular = finding["line"] == 12;
    CHECK((regular || finding["line"] == 21 || finding["line"] == 22));
    CHECK(message.find(regular ? "000L" : finding["line"] == 21 ? "001R" : "004L") == 4);
    CHECK_FALSE(finding["hint"].get<std::string>().empty());
  }
  CHECK(unseen == 3);
  const std::string allowed =
      write_text(folder.path() / "s.yaml",
                 replaced(high, "  - { tag: 001R",
                          "  # tagsmith: allow unseen-tag: for people\n  - { tag: 001R"));
  const ProgramOutput without = run_tagsmith("validate '" + allowed + "'");
  CHECK(without.out.find("unused-allow") == std::string::npos);
  const auto with_rig =
      json_lines(run_tagsmith("validate --json '" + allowed + "' --rig " + rig).out);
  int left = 0;
  for (const json& finding : with_rig) {
    CHECK(finding["code"] != "unused-allow");
    left += finding["code"] == "unseen-tag" ? 1 : 0;
  }
  CHECK(left == 2);
}

TEST_CASE("validate --rig refuses the vehicle that plan refuses, in its words") {
  const TemporaryFolder folder;
  const std::string survey = "surveys/drift/survey.yaml";
  const std::string right = *tagsmith::detail::read_file("surveys/drift/rig.yaml");
  for (const char* wrong : {"lateral: 2.3", "lateral: 0.02"}) {
    CAPTURE(wrong);
    const std::regex lateral("lateral: [0-9.]+");
    const std::string rig =
        write_text(folder.path() / "rig.yaml", std::regex_replace(right, lateral, wrong));
    const ProgramOutput plan = run_tagsmith("plan --from 1 --to 2 " + survey + " --rig " + rig);
    const ProgramOutput output = run_tagsmith("validate " + survey + " --rig " + rig);
    const bool is_refused = output.out.find("[vehicle-room]") != std::string::npos;
    CHECK(output.exit_code == (is_refused ? 1 : 0));
    CHECK(is_refused == (plan.exit_code == 2));
    CHECK(is_refused == (wrong == std::string("lateral: 2.3")));
    const std::string words = "vehicle.envelope.lateral is 2.3 m, expected less than";
    CHECK(is_refused == (plan.err.find(words) != std::string::npos));
    CHECK(is_refused == (output.out.find(words) != std::string::npos));
  }
}

TEST_CASE("codes that two surveys share are named with the lines of both") {
  const TemporaryFolder folder;
  const std::string one = write_text(folder.path() / "one.yaml", right_survey());
  const std::string two = write_text(folder.path() / "two.yaml",
                                     replaced(right_survey(), "survey: trial", "survey: other"));
  const ProgramOutput output = run_tagsmith("validate --json '" + one + "' '" + two + "'");
  CHECK(output.exit_code == 1);
  bool is_named = false;
  for (const json& finding : json_lines(output.out)) {
    if (finding["code"] != "code-collision" || finding["line"] != 21) continue;
    const std::string message = finding["message"];
    CHECK(finding["file"] == two);
    CHECK(finding["column"] == 5);
    CHECK(message.find("001R") != std::string::npos);
    CHECK(message.ends_with(one + ":21"));
    is_named = true;
  }
  CHECK(is_named);
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
  CHECK(output.err.find("2 files: ") == 0);
  const ProgramOutput as_json =
      run_tagsmith("validate --json '" + survey + "' --rig '" + rig + "'");
  const json misspelt = finding_of(as_json, survey, "unknown-key");
  CHECK(misspelt["line"] == 15);
  CHECK(misspelt["column"] == 3);
  CHECK(misspelt["fix"]["found"] == "spaceing");
  const json in_rig = finding_of(as_json, rig, "unknown-key");
  CHECK(in_rig["line"] == 7);
  CHECK(in_rig["column"] == 5);
  CHECK(in_rig["message"].get<std::string>().find("`alfa`") != std::string::npos);
}

TEST_CASE("a survey, rig or template in the place of another is named once, with its place") {
  const std::string rig = "surveys/corridor/rig.yaml";
  const std::string plate = "templates/tag-400x300.yaml";
  const std::string survey = "surveys/corridor/survey.yaml";
  struct Case {
    std::string option, file, found, expected;
    int line;
  };
  const Case cases[] = {{"", rig, "rig", "survey", 3},
                        {"", plate, "template", "survey", 3},
                        {"--rig ", survey, "survey", "rig", 2},
                        {"--template ", rig, "rig", "template", 3}};
  for (const Case& one : cases) {
    CAPTURE(one.option + one.file);
    const ProgramOutput output = run_tagsmith("validate --json " + one.option + one.file);
    CHECK(output.exit_code == 1);
    CHECK(output.err == "1 file: 1 error, 0 warnings\n");
    REQUIRE(json_lines(output.out).size() == 1);
    const json finding = finding_of(output, one.file, "wrong-kind");
    CHECK(finding["line"] == one.line);
    CHECK(finding["column"] == 1);
    const std::string message = finding["message"];
    const std::size_t found = message.find(one.found);
    CHECK(found != std::string::npos);
    CHECK(message.find(one.expected, found) != std::string::npos);
  }
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
    const auto finding = parsed_json(line);
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
  CHECK(output.err.find("absent.yaml: ") != std::string::npos);
  CHECK(run_tagsmith("validate '" + folder.path().string() + "'").exit_code == 2);
  CHECK(run_tagsmith("validate").exit_code == 2);
  CHECK(run_tagsmith("validate --nonsense").exit_code == 2);
}

TEST_CASE("validate --help shows an example") {
  const ProgramOutput output = run_tagsmith("validate --help");
  CHECK(output.exit_code == 0);
  CHECK(output.out.find("tagsmith validate surveys/corridor/survey.yaml") != std::string::npos);
}
