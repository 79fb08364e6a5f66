// SPDX-License-Identifier: Apache-2.0
// What is written is what `patch` makes the new text of.
#include "tagsmith/base/unified_diff.hpp"

#include <fstream>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

std::string patched(const std::string& text, const std::string& diff) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "text", changes = folder.path() / "changes";
  std::ofstream(file) << text;
  std::ofstream(changes) << diff;
  const ProgramOutput done =
      run_shell("patch -s '" + file.string() + "' '" + changes.string() + "'");
  REQUIRE(done.exit_code == 0);
  return contents(file);
}

std::string random_lines(std::mt19937& random, int count) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += std::string(1, static_cast<char>('a' + random() % 6)) + "\n";
  return text;
}

}  // namespace

TEST_CASE("a changed line stands between three lines on either side") {
  const std::string before = "1\n2\n3\n4\n5\n6\n7\n8\n9\n",
                    after = "1\n2\n3\n4\nfive\n6\n7\n8\n9\n";
  CHECK(unified_diff("a", before, "b", after) ==
        "--- a\n+++ b\n@@ -2,7 +2,7 @@\n 2\n 3\n 4\n-5\n+five\n 6\n 7\n 8\n");
  CHECK(unified_diff("a", before, "b", before).empty());
}

TEST_CASE("patch makes the new text of it") {
  REQUIRE_MESSAGE(has_program("patch"), "patch is missing: install patch");
  CHECK(patched("a\nb", unified_diff("a", "a\nb", "b", "a\nc\n")) == "a\nc\n");
  CHECK(patched("", unified_diff("a", "", "b", "a\n")) == "a\n");
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) {
    const std::string before = random_lines(random, static_cast<int>(random() % 40) + 1);
    const std::string after = random_lines(random, static_cast<int>(random() % 40) + 1);
    CAPTURE(before);
    CAPTURE(after);
    if (before != after) CHECK(patched(before, unified_diff("a", before, "b", after)) == after);
  }
}
