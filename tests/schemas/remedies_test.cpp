// SPDX-License-Identifier: Apache-2.0
// What remedies tell people to type exists: options of commands, keys of files.
#include <algorithm>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "decoder/verify/verify_rules.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/survey/rules.hpp"
#include "tests/support/json.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using nlohmann::json;
using tagsmith::detail::test::parsed_json;
using tagsmith::detail::test::run_tagsmith;

namespace {

// What every rule tells, the remedies of `verify` among it.
std::vector<std::string> all_remedies() {
  std::vector<std::string> texts;
  for (const Rule& rule : verify_rules()) texts.emplace_back(rule.remedy);
  for (const Rule& rule : rules()) texts.emplace_back(rule.remedy);
  return texts;
}

std::vector<std::smatch> matches(const std::string& text, const std::regex& expression) {
  return {std::sregex_iterator(text.begin(), text.end(), expression), std::sregex_iterator()};
}

// Whether a schema has the section, and the key in it or in what it refers to.
bool has_key(const json& schema, const std::string& section, const std::string& key) {
  return schema.at("properties").contains(section) &&
         schema.dump().find("\"" + key + "\":") != std::string::npos;
}

}  // namespace

TEST_CASE("what verify tells the people at the wall names no option of the program") {
  for (const Rule& rule : verify_rules()) {
    CAPTURE(rule.remedy);
    CHECK(rule.remedy.find("--") == std::string::npos);
    CHECK(rule.remedy.find("tagsmith ") == std::string::npos);
  }
}

TEST_CASE("every option that a rule names is one of the program") {
  std::string helps;
  for (const char* command : {"new", "validate", "plan", "localize", "print", "draw"}) {
    helps += run_tagsmith(std::string(command) + " --help").out;
  }
  int options = 0;
  for (const std::string& text : all_remedies()) {
    for (const std::smatch& option : matches(text, std::regex("--[a-z-]+"))) {
      CAPTURE(text);
      CHECK_MESSAGE(helps.find(option.str()) != std::string::npos, option.str());
      ++options;
    }
  }
  CHECK(options >= 4);
}

TEST_CASE("every key of a file that a remedy names is in a schema") {
  std::vector<json> schemas;
  for (const char* name : {"survey", "rig", "template", "board"}) {
    const auto text = read_file("docs/schemas/" + std::string(name) + ".schema.json");
    REQUIRE(text.has_value());
    schemas.push_back(parsed_json(*text));
  }
  const std::regex key(
      R"(\b(tags|code|tunnel|grid|symbol|label|vehicle|plate|feature_frame|cameras|ranges)\.([a-z_]+))");
  int keys = 0;
  for (const std::string& text : all_remedies()) {
    for (const std::smatch& found : matches(text, key)) {
      CAPTURE(text);
      const bool known = std::ranges::any_of(schemas, [&](const json& schema) {
        return has_key(schema, found[1].str(), found[2].str());
      });
      CHECK_MESSAGE(known, found.str());
      ++keys;
    }
  }
  CHECK(keys >= 5);
}
