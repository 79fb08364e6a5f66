// SPDX-License-Identifier: Apache-2.0
// One catalogue of rules: what the sources report and what docs/verify-rules.md says.
#include "decoder/verify/verify_rules.hpp"

#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"

namespace tagsmith::detail {

TEST_CASE("every rule of the catalogue is reported somewhere") {
  std::string sources;
  for (const char* folder : {"decoder/verify", "decoder/cli"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().filename() != "verify_rules.cpp" && entry.path().extension() == ".cpp") {
        sources += *read_file(entry.path());
      }
    }
  }
  CHECK(verify_rules().size() > 20);
  for (const VerifyRule& rule : verify_rules()) {
    CAPTURE(rule.code);
    CHECK(sources.find("\"" + std::string(rule.code) + "\"") != std::string::npos);
    CHECK(find_verify_rule(rule.code) == &rule);
  }
  CHECK(find_verify_rule("no-such-rule") == nullptr);
}

TEST_CASE("docs/verify-rules.md has the table") {
  CHECK(read_file("docs/verify-rules.md")->find(verify_rules_table()) != std::string::npos);
}

}  // namespace tagsmith::detail
