// SPDX-License-Identifier: Apache-2.0
// Files made to harm: the answer is a finding, soon and in little memory.
#include <chrono>
#include <filesystem>

#include <doctest/doctest.h>

#include "tagsmith/survey/read_survey.hpp"
#include "tests/support/program.hpp"
#include "tests/survey/files.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

std::string repeated(const std::string& text, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += text;
  return result;
}

std::string aliases_of_aliases() {
  std::string text = "a: &a [x, x, x, x, x, x, x, x, x]\n";
  for (char c = 'b'; c <= 'k'; ++c) {
    const std::string before(1, static_cast<char>(c - 1));
    text += std::string(1, c) + ": &" + c + " [" + repeated("*" + before + ", ", 9) + "]\n";
  }
  return text;
}

}  // namespace

TEST_CASE("hostile files are refused by a finding, quickly") {
  const struct {
    std::string name;
    std::string text;
    const char* code;
  } cases[] = {
      {"nothing", "", "empty-file"},
      {"a comment", "# nothing\n", "empty-file"},
      {"a list", "- a\n- b\n", "wrong-type"},
      {"a word", "word\n", "wrong-type"},
      {"aliases of aliases", aliases_of_aliases(), "alias"},
      {"deep brackets", repeated("[", 1'000'000), "too-deep"},
      {"deep brackets, a line each", repeated("[\n", 1'000'000), "too-deep"},
      {"deep braces", repeated("{a: ", 1'000'000), "too-deep"},
      {"deep dashes", repeated("- ", 500'000), "too-deep"},
      {"deep keys", repeated("? ", 500'000), "too-deep"},
      {"deep brackets behind a quote", "a: it's\nb: " + repeated("[", 1'000'000), "too-deep"},
      {"a long list in brackets", "[" + repeated("1, ", 1'000'000) + "]", "long-flow"},
      {"an open quote", "survey: \"" + repeated("x\n", 100'000), "open-quote"},
      {"thousands of keys", repeated("key: 1\n", 20'000), "unknown-key"},
      {"NUL", std::string("survey: a\0b\n", 12), "not-utf-8"},
      {"UTF-16", std::string("\xFF\xFEs\0u\0", 6), "not-utf-8"},
      {"overlong UTF-8", "survey: \xC0\xAF\n", "not-utf-8"},
  };
  const TemporaryFolder folder;
  for (const auto& hostile : cases) {
    CAPTURE(hostile.name);
    const auto start = std::chrono::steady_clock::now();
    const auto reading = read_survey(write_text(folder.path() / "s.yaml", hostile.text));
    REQUIRE(reading.has_value());
    CHECK_FALSE(reading->value.has_value());
    CHECK_MESSAGE(count_findings(reading->diagnostics, hostile.code) >= 1,
                  to_string(reading->diagnostics).substr(0, 1000));
    CHECK(reading->diagnostics.size() < 1000);
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
  }
}

TEST_CASE("control characters of a file are spelt out in messages") {
  const TemporaryFolder folder;
  const std::string text = replaced(right_survey(), "survey: trial", R"(survey: "\e[31m\nred")");
  const auto reading = read_survey(write_text(folder.path() / "s.yaml", text));
  REQUIRE(reading.has_value());
  const std::string message = to_string(reading->diagnostics);
  CHECK_MESSAGE(message.find(R"("\x1b[31m\x0ared")") != std::string::npos, message);
  CHECK(message.find('\x1b') == std::string::npos);
}

TEST_CASE("a template that is not there is answered with the shipped ones") {
  const TemporaryFolder folder;
  const std::string text = replaced(right_survey(), "template: tag-400x300", "template: tag-4");
  const auto reading = read_survey(write_text(folder.path() / "s.yaml", text));
  REQUIRE(reading.has_value());
  for (const auto& entry : std::filesystem::directory_iterator("templates")) {
    const std::string name = entry.path().stem().string();
    CAPTURE(name);
    CHECK(to_string(reading->diagnostics).find(name) != std::string::npos);
  }
}

TEST_CASE("brackets and hash signs in text and comments count for nothing") {
  std::string text = replaced(right_survey(), "survey: trial",
                              "survey: \"tri'al [[[[ {{{{ # \"  # " + repeated("[", 100));
  text = replaced(text, "tags:", "# it's " + repeated("{", 100) + "\ntags:");
  text = replaced(text, "code: {", "code:\t# " + repeated("[", 100) + "\n  {");
  const TemporaryFolder folder;
  const auto reading = read_survey(write_text(folder.path() / "s.yaml", text));
  REQUIRE(reading.has_value());
  CHECK_MESSAGE(reading->value.has_value(), to_string(reading->diagnostics));
}

TEST_CASE("a hundred thousand tags are placed and checked in seconds") {
  std::string text = replaced(right_survey(), "{ line: 12.0 }", "{ line: 90000.0 }");
  text = replaced(text, "pairs: 4", "pairs: 50000");
  text =
      replaced(text, "resolution: 0.01, digits: [4, 4, 3]", "resolution: 0.1, digits: [3, 6, 2]");
  text = replaced(text, "placed:\n  - { tag: 001R, side: right, p: [12.0, 22.4, 1.4] }\n", "");
  text = replaced(
      text, "  - { tag: 004L, side: left, p: [8.0, 25.0, 1.4], digits: \"000000000017\" }\n", "");
  const TemporaryFolder folder;
  const auto start = std::chrono::steady_clock::now();
  const auto reading = read_survey(write_text(folder.path() / "s.yaml", text));
  REQUIRE(reading.has_value());
  CHECK_MESSAGE(reading->value.has_value(), to_string(reading->diagnostics));
  CHECK(reading->value->tags.size() == 100'000);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
}

TEST_CASE("ten thousand plates on one spot give a hundred findings and a count") {
  std::string text = right_survey();
  for (int pair = 1000; pair < 11'000; ++pair) {
    text += "  - { tag: " + std::to_string(pair) + "L, side: left, p: [8.0, 28.0, 1.4] }\n";
  }
  const TemporaryFolder folder;
  const auto reading = read_survey(write_text(folder.path() / "s.yaml", text));
  REQUIRE(reading.has_value());
  CHECK(count_findings(reading->diagnostics, "overlap") == 101);
  CHECK(count_findings(reading->diagnostics, "code-collision") == 101);
  CHECK(to_string(reading->diagnostics).find(" 9899 ") != std::string::npos);
}
