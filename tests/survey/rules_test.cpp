// SPDX-License-Identifier: Apache-2.0
// One catalogue of rules: what the sources report, what --explain knows, what docs/rules.md says.
#include "tagsmith/survey/rules.hpp"

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
namespace fs = std::filesystem;

namespace {

constexpr const char* kDateShape = "dddd-dd-dd";

// The sources of what reads and checks a user's files.
std::string reading_sources() {
  std::string sources;
  for (const char* folder : {"tagsmith/survey", "tagsmith/draft"}) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".cpp") sources += *read_file(entry.path());
    }
  }
  return sources;
}

// Every text in these sources that has the shape of a rule's code: words joined by hyphens.
std::set<std::string> codes_in_sources() {
  std::set<std::string> codes;
  const std::regex code("\"([a-z0-9]+(-[a-z0-9]+)+)\"");
  const std::string text = reading_sources();
  for (std::sregex_iterator match(text.begin(), text.end(), code), end; match != end; ++match) {
    if ((*match)[1] != kDateShape) codes.insert((*match)[1]);
  }
  return codes;
}

}  // namespace

TEST_CASE("every rule that is reported is in the catalogue") {
  const std::set<std::string> codes = codes_in_sources();
  CHECK(codes.size() > 40);
  for (const std::string& code : codes) {
    CAPTURE(code);
    CHECK(find_rule(code) != nullptr);
  }
}

TEST_CASE("every rule of the catalogue is reported somewhere") {
  const std::string sources =
      *read_file("tagsmith/survey/rules.hpp") + reading_sources();  // that of survey and rig
  for (const Rule& rule : rules()) {
    CAPTURE(rule.code);
    CHECK(sources.find("\"" + std::string(rule.code) + "\"") != std::string::npos);
  }
}

TEST_CASE("rules are the rows of a document's table") {
  const std::string document =
      "# Rules\n| rule | finds | remedy |\n|---|---|---|\n"
      "| `a-b` | one thing | take left|right | rehang |\n"
      "| `no-remedy` | another |\n| `c` | a third | mend it. |\n";
  const std::vector<Rule> rules = rules_in(document);
  REQUIRE(rules.size() == 2);
  CHECK(rules[0].code == "a-b");
  CHECK(rules[0].finds == "one thing");
  CHECK(rules[0].remedy == "take left|right");
  CHECK(rules[0].action == "rehang");
  CHECK(rules[1].action.empty());
  CHECK(find_rule("c", rules) == &rules[1]);
  CHECK(find_rule("no-remedy", rules) == nullptr);
}

TEST_CASE("docs/rules.md has the table that validate --rules prints") {
  const ProgramOutput output = run_tagsmith("validate --rules");
  CHECK(output.exit_code == 0);
  CHECK(read_file("docs/rules.md")->find(output.out) != std::string::npos);
}

TEST_CASE("--explain tells what a rule is about, and knows near misses") {
  const ProgramOutput known = run_tagsmith("validate --explain spacing-outlier");
  CHECK(known.exit_code == 0);
  CHECK(known.out.find("147.19") != std::string::npos);
  const ProgramOutput unknown = run_tagsmith("validate --explain spacing-outlie");
  CHECK(unknown.exit_code == 2);
  CHECK(unknown.err.find("spacing-outlier?") != std::string::npos);
}
