// SPDX-License-Identifier: Apache-2.0
// What the sources report and what docs/verify-rules.md says are the same rules.
#include "decoder/verify/verify_rules.hpp"

#include <filesystem>
#include <regex>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"

namespace tagsmith::detail {
namespace {

std::string sources_that_report() {
  std::string sources;
  for (const char* folder : {"decoder/plates", "decoder/verify", "decoder/cli"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".cpp") sources += *read_file(entry.path());
    }
  }
  return sources;
}

}  // namespace

TEST_CASE("every rule that is reported is in docs/verify-rules.md") {
  const std::string sources = sources_that_report();
  const std::regex report(R"re((?:TagStatus::\w+,|Diagnosis\{|add_finding\()\s*"([a-z-]+)",)re");
  int reports = 0;
  for (std::sregex_iterator at(sources.begin(), sources.end(), report), end; at != end; ++at) {
    CAPTURE((*at)[1].str());
    CHECK(find_verify_rule((*at)[1].str()) != nullptr);
    ++reports;
  }
  CHECK(reports > 30);
}

TEST_CASE("every rule of docs/verify-rules.md is reported somewhere") {
  const std::string sources = sources_that_report();
  CHECK(verify_rules().size() > 20);
  for (const Rule& rule : verify_rules()) {
    CAPTURE(rule.code);
    CHECK(sources.find("\"" + std::string(rule.code) + "\"") != std::string::npos);
    CHECK(find_verify_rule(rule.code) == &rule);
  }
  CHECK(find_verify_rule("no-such-rule") == nullptr);
}

}  // namespace tagsmith::detail
