// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/edit_yaml.hpp"

#include <doctest/doctest.h>

using namespace tagsmith::detail;

namespace {

std::string edited(const std::string& text, const std::vector<YamlEdit>& edits) {
  const Result<std::string> result = edit_yaml(text, edits);
  REQUIRE_MESSAGE(result.has_value(), result.error().message);
  return *result;
}

}  // namespace

TEST_CASE("a value changes, and nothing else") {
  const std::string text =
      "survey: a  # spacing: 3\ntags:\n  # the gap\n  spacing: 0.4   # W_B\n  pairs: 8\n";
  CHECK(edited(text, {{{"tags"}, "spacing", "1.25", ""}}) ==
        "survey: a  # spacing: 3\ntags:\n  # the gap\n  spacing: 1.25   # W_B\n  pairs: 8\n");
}

TEST_CASE("a missing key becomes the first, in block and in flow maps") {
  CHECK(edited("tags:\n  spacing: 0.4\n", {{{"tags"}, "theta", "20", ""}}) ==
        "tags:\n  theta: 20\n  spacing: 0.4\n");
  CHECK(edited("tags: { spacing: 0.4 }\n", {{{"tags"}, "theta", "20", ""}}) ==
        "tags: { theta: 20, spacing: 0.4 }\n");
}

TEST_CASE("a key takes another's place, several changes at once") {
  CHECK(edited("é: 1\ntags: { spacing: 0.4, to: 11, x: { alpha: 35 } }\n",
               {{{"tags"}, "pairs", "7", "to"},
                {{"tags"}, "spacing", "2", ""},
                {{"tags", "x"}, "alpha", "50", ""}}) ==
        "é: 1\ntags: { spacing: 2, pairs: 7, x: { alpha: 50 } }\n");
  CHECK(edited("\"é\": {\"ü\": 1, alpha: 35}\n", {{{"é"}, "alpha", "5", ""}}) ==
        "\"é\": {\"ü\": 1, alpha: 5}\n");
}

TEST_CASE("what cannot be changed is refused") {
  CHECK_FALSE(edit_yaml("tags: {", {{{"tags"}, "pairs", "7", ""}}).has_value());
  CHECK_FALSE(edit_yaml("a: 1\n", {{{"tags"}, "pairs", "7", ""}}).has_value());
  CHECK_FALSE(edit_yaml("tags: 3\n", {{{"tags"}, "pairs", "7", ""}}).has_value());
  CHECK_FALSE(edit_yaml("tags: { pairs: [3] }\n", {{{"tags"}, "pairs", "7", ""}}).has_value());
}
