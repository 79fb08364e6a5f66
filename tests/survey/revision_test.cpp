// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/revision.hpp"

#include <algorithm>
#include <string>

#include <doctest/doctest.h>

#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

std::string revision_of(const std::string& text) {
  const TemporaryFolder folder;
  return survey_revision(load_survey(write_text(folder.path() / "s.yaml", text)).value());
}

}  // namespace

TEST_CASE("a survey's revision is twelve hexadecimal digits that comments do not change") {
  const std::string revision = revision_of(right_survey());
  CHECK(revision.size() == 12);
  CHECK(revision.find_first_not_of("0123456789abcdef") == std::string::npos);
  CHECK(revision_of("# measured again\n" + right_survey()) == revision);
}

TEST_CASE("whatever a survey says changes its revision") {
  const std::string revision = revision_of(right_survey());
  for (const auto& [from, to] :
       {std::pair{"width: 4.0", "width: 4.001"}, std::pair{"sigma: 0.003", "sigma: 0.004"},
        std::pair{"height: 3.0", "height: 3.1"}, std::pair{"pairs: 4", "pairs: 3"},
        std::pair{"[12.0, 22.4, 1.4]", "[12.0, 22.4, 1.401]"}}) {
    CAPTURE(to);
    if (right_survey().find(from) == std::string::npos) FAIL("no " << from);
    CHECK(revision_of(replaced(right_survey(), from, to)) != revision);
  }
}
