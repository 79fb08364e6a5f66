// SPDX-License-Identifier: Apache-2.0
// Mechanical remedies, and findings shown on the text they are about.
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/apply_fixes.hpp"
#include "tagsmith/cli/source_excerpt.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

Diagnostic finding(int line, int column, std::string found, std::string replacement) {
  return {"s.yaml", line,      column, Severity::error,
          "rule",   "message", "hint", TextEdit{std::move(found), std::move(replacement)}};
}

}  // namespace

TEST_CASE("remedies are written at their places, several on a line, and nothing else changes") {
  const FixedText fixed = apply_fixes(
      "a: 1,5  # one, two\nb: { c: '07', d: x }\n",
      {finding(1, 4, "1,5", "1.5"), finding(2, 9, "\"07\"", "7"), finding(2, 15, "d", "dd")});
  CHECK(fixed.text == "a: 1.5  # one, two\nb: { c: 7, dd: x }\n");
  REQUIRE(fixed.lines.size() == 2);
  CHECK(fixed.lines[1].before == "b: { c: '07', d: x }");
  CHECK(fixed.lines[0].codes == std::vector<std::string>{"rule"});
  CHECK(fixed.lines[1].codes.size() == 2);
}

TEST_CASE("a remedy for other text than stands there is left out") {
  const std::string text = "a: 1,5\n";
  CHECK(apply_fixes(text, {finding(1, 4, "2,5", "2.5")}).text == text);
  CHECK(apply_fixes(text, {finding(1, 90, "1,5", "1.5")}).text == text);
  CHECK(apply_fixes(text, {finding(9, 1, "1,5", "1.5")}).lines.empty());
}

TEST_CASE("validate --fix mends what is mechanical, keeps comments, reports the rest") {
  const TemporaryFolder folder;
  const std::string right = right_survey() + "# the end\n";
  std::string text = replaced(right, "spacing:", "spaceing:");
  text = replaced(text, "width: 4.0", "width: 4,0   # measured twice");
  text = replaced(text, "gs1", "xyz");
  const std::string path = write_text(folder.path() / "s.yaml", text);
  const ProgramOutput output = run_tagsmith("validate --fix '" + path + "'");
  CHECK(output.exit_code == 1);
  CHECK(output.out.find(path + ":4: mended [decimal-comma]\n  - width: 4,0   # measured twice\n"
                               "  + width: 4.0   # measured twice\n") != std::string::npos);
  CHECK(output.out.find("[bad-choice]") != std::string::npos);
  const std::string expected =
      replaced(replaced(right, "width: 4.0", "width: 4.0   # measured twice"), "gs1", "xyz");
  CHECK(*read_file(path) == expected);
}

TEST_CASE("validate --fix leaves a file without mechanical faults as it is") {
  const TemporaryFolder folder;
  const std::string path = write_text(folder.path() / "s.yaml", right_survey());
  const auto written = std::filesystem::last_write_time(path);
  const ProgramOutput output = run_tagsmith("validate --fix '" + path + "'");
  CHECK(output.exit_code == 0);
  CHECK(output.out.empty());
  CHECK(std::filesystem::last_write_time(path) == written);
  CHECK(*read_file(path) == right_survey());
}

TEST_CASE("each remedy that validate offers in JSON leads to a right file") {
  const TemporaryFolder folder;
  const std::string path =
      write_text(folder.path() / "s.yaml", replaced(right_survey(), "spacing:", "spaceing:"));
  const ProgramOutput output = run_tagsmith("validate --json '" + path + "'");
  CHECK(output.out.find(R"("fix":{"found":"spaceing","replacement":"spacing"})") !=
        std::string::npos);
  const ProgramOutput fixed = run_tagsmith("validate --fix --json '" + path + "'");
  CHECK(fixed.exit_code == 0);
  CHECK(parsed_json(fixed.out)["fixed"][0] == "unknown-key");
  CHECK(*read_file(path) == right_survey());
}

TEST_CASE("the excerpt underlines the offending text, in characters") {
  CHECK(source_excerpt(finding(2, 8, "wert", "wort"), "x\ngröße: wert # ü\n") ==
        "    2 | größe: wert # ü\n      |      ^~~~\n");
  Diagnostic plain = finding(1, 4, "", "");
  plain.fix.reset();
  CHECK(source_excerpt(plain, "a: \"b c\" d\n") == "    1 | a: \"b c\" d\n      |    ^~~~~\n");
}

TEST_CASE("the excerpt underlines a line's first word too") {
  CHECK(source_excerpt(finding(1, 1, "wert", "wort"), "wert: 1\n") ==
        "    1 | wert: 1\n      | ^~~~\n");
}

TEST_CASE("the excerpt of a long line shows the part around the finding") {
  const std::string line = std::string(5000, 'a') + " bad " + std::string(5000, 'b');
  Diagnostic plain = finding(1, 5002, "", "");
  plain.fix.reset();
  const std::string excerpt = source_excerpt(plain, line);
  CHECK(excerpt.size() < 250);
  CHECK(excerpt.find(" bad ") != std::string::npos);
  CHECK(excerpt.find("^~~\n") != std::string::npos);
}

TEST_CASE("what cannot be shown has no excerpt") {
  Diagnostic plain = finding(3, 1, "", "");
  plain.fix.reset();
  CHECK(source_excerpt(plain, "one\ntwo\n").empty() == false);  // the empty third line
  plain.line = 9;
  CHECK(source_excerpt(plain, "one\ntwo\n").empty());
  plain.line = 1;
  CHECK(source_excerpt(plain, "\x1b[31m\n").empty());
  plain.line = 0;
  CHECK(source_excerpt(plain, "one\n").empty());
}
