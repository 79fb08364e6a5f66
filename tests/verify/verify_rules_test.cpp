// SPDX-License-Identifier: Apache-2.0
// What the sources report and what docs/verify-rules.md says are the same rules.
#include "decoder/verify/verify_rules.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <regex>
#include <span>
#include <string>
#include <string_view>

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
    const std::string code = (*at)[1].str();
    CHECK_MESSAGE(find_verify_rule(code) != nullptr,
                  "docs/verify-rules.md has no row of four columns for " << code);
    ++reports;
  }
  CHECK(reports > 30);
}

TEST_CASE("every rule of docs/verify-rules.md is reported somewhere") {
  const std::string sources = sources_that_report();
  CHECK(verify_rules().size() > 20);
  for (const Rule& rule : verify_rules()) {
    CAPTURE(rule.code);
    CHECK_MESSAGE(sources.find("\"" + std::string(rule.code) + "\"") != std::string::npos,
                  "no source names it: report it, or remove its row from docs/verify-rules.md");
    CHECK(find_verify_rule(rule.code) == &rule);
  }
  CHECK(find_verify_rule("no-such-rule") == nullptr);
}

// A word that the ledger does not know would be taken for "-" without a word.
TEST_CASE("the last column of a rule is a cure that the ledger asks for, or none") {
  constexpr std::array<std::string_view, 4> kCures{"reprint", "clean", "rehang", "-"};
  for (const Rule& rule : verify_rules()) {
    CHECK_MESSAGE(
        std::ranges::find(kCures, rule.action) != kCures.end(),
        "docs/verify-rules.md: the last column of " << rule.code << " is '" << rule.action << "'");
  }
}

TEST_CASE("docs/verify-rules.md has its rules in the order of the alphabet") {
  const std::span<const Rule> all = verify_rules();
  const auto unsorted = std::ranges::is_sorted_until(all, {}, &Rule::code);
  CHECK_MESSAGE(unsorted == all.end(), unsorted->code << " stands too far down");
}

}  // namespace tagsmith::detail
