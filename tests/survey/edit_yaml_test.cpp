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

TEST_CASE("an item is added behind one whose dash stands on a line of its own") {
  for (const char* item : {"  -\n    tag: 002L\n    tilt: -0.0\n", "  - # a - b\n    tag: 002L\n",
                           "  - tag: 002L\n    tilt: -0.0\n"}) {
    CAPTURE(std::string(item));
    const std::string text = "placed:\n" + std::string(item);
    CHECK(edit_yaml_list(text, "placed", {}, {"{ tag: 003L }"}).value() ==
          text + "  - { tag: 003L }\n");
  }
}

TEST_CASE("a missing list is put at the end of the document, which a line of dots may end") {
  for (const char* end : {"", "...", "...\n", "... # all\n"}) {
    CAPTURE(std::string(end));
    CHECK(edit_yaml_list("survey: a...\n" + std::string(end), "placed", {}, {"{ tag: 003L }"})
              .value() == "survey: a...\nplaced:\n  - { tag: 003L }\n" + std::string(end));
  }
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

namespace {

std::string without(const std::string& text, const std::vector<std::string>& path,
                    const std::vector<std::string>& keys) {
  const Result<std::string> result = remove_yaml_keys(text, path, keys);
  REQUIRE_MESSAGE(result.has_value(), result.error().message);
  return *result;
}

}  // namespace

TEST_CASE("a key goes with its value and its lines, comments of others stay") {
  const std::string text =
      "cameras:\n"
      "  # the left one\n"
      "  left:\n"
      "    size: [1, 2]   # pixels\n"
      "    # by data sheet\n"
      "    lens:\n"
      "      focal: 6\n"
      "\n"
      "      sensor: [4.8,\n"
      "        3.6]\n"
      "    # turned\n"
      "    alpha: 35\n"
      "  right: { lens: 1 }\n";
  CHECK(without(text, {"cameras", "left"}, {"lens", "yaw"}) ==
        "cameras:\n"
        "  # the left one\n"
        "  left:\n"
        "    size: [1, 2]   # pixels\n"
        "    # by data sheet\n"
        "    # turned\n"
        "    alpha: 35\n"
        "  right: { lens: 1 }\n");
  CHECK(without("a:\n- 1\n- 2\nb: 3", {}, {"a"}) == "b: 3");
  CHECK(without("a: 1\nb: |\n  some\n\n  text\n# end\n", {}, {"b"}) == "a: 1\n# end\n");
}

TEST_CASE("a key goes out of a flow map, whatever stands beside it") {
  const std::string text =
      "m: { a: [1, { x: 2 }], b: \"}, #\", c: don't, d: { e: 'it''s' } } # end\n";
  CHECK(without(text, {"m"}, {"a"}) == "m: { b: \"}, #\", c: don't, d: { e: 'it''s' } } # end\n");
  CHECK(without(text, {"m"}, {"b", "c"}) == "m: { a: [1, { x: 2 }], d: { e: 'it''s' } } # end\n");
  CHECK(without(text, {"m"}, {"c", "d"}) == "m: { a: [1, { x: 2 }], b: \"}, #\" } # end\n");
  CHECK(without(text, {"m", "d"}, {"e"}) ==
        "m: { a: [1, { x: 2 }], b: \"}, #\", c: don't, d: {  } } # end\n");
  CHECK(without("m: {\n  a: 1, # one }\n  b: 2,\n  c: 3\n}\n", {"m"}, {"b"}) ==
        "m: {\n  a: 1, # one }\n  c: 3\n}\n");
}

TEST_CASE("what cannot be removed alone is refused") {
  CHECK_FALSE(remove_yaml_keys("a: [", {}, {"a"}).has_value());
  CHECK_FALSE(remove_yaml_keys("a: 1\n", {"b"}, {"c"}).has_value());
  CHECK_FALSE(remove_yaml_keys("a: 1\n", {"a"}, {"c"}).has_value());
  // A map without keys is none.
  CHECK_FALSE(remove_yaml_keys("a:\n  b: 1\n", {"a"}, {"b"}).has_value());
}
