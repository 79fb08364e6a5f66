// SPDX-License-Identifier: Apache-2.0
// The commands printed in the documents run, end as said and print what is shown; and the pages and
// pictures that the documents point to are there.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/readme/documents.hpp"
#include "tests/support/contents.hpp"

namespace fs = std::filesystem;

namespace tagsmith::detail::test {
namespace {

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text + "\n";
  return all;
}

std::vector<fs::path> documents() {
  std::vector<fs::path> files{"README.md"};
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator("docs")) {
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  }
  return files;
}

// Targets of the Markdown links in a text that name files.
std::vector<std::string> linked_files(const std::string& text) {
  static const std::regex link(R"(\]\(([^)#\s]+))");
  std::vector<std::string> files;
  for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
    const std::string target = (*at)[1];
    if (target.find("://") == std::string::npos) files.push_back(target);
  }
  return files;
}

}  // namespace

TEST_CASE("the commands of README.md run and print what it shows") {
  const DocumentRun run = run_document(contents("README.md"));
  CHECK(run.commands >= 7);
  CHECK_MESSAGE(run.failures.empty(), joined(run.failures));
}

TEST_CASE("the commands of docs/user-guide.md run and print what it shows") {
  const DocumentRun run = run_document(contents("docs/user-guide.md"));
  CHECK(run.commands >= 10);
  CHECK_MESSAGE(run.failures.empty(), joined(run.failures));
}

TEST_CASE("every file that a document links to exists") {
  const std::vector<fs::path> files = documents();
  CHECK(files.size() >= 6);
  for (const fs::path& file : files) {
    for (const std::string& target : linked_files(contents(file))) {
      CHECK_MESSAGE(fs::exists(file.parent_path() / target), file.string() << ": " << target);
    }
  }
}

TEST_CASE("a command that fails, or ends otherwise than said, is found") {
  const DocumentRun fails = run_document("```sh\ntagsmith validate missing.yaml\n```\n");
  CHECK(fails.commands == 1);
  REQUIRE(fails.failures.size() == 1);
  CHECK(fails.failures[0].find("ends with 2, expected 0") != std::string::npos);
  CHECK(run_document("```sh exit=2\ntagsmith validate missing.yaml\n```\n").failures.empty());
  CHECK(run_document("```sh exit=1\ntagsmith read --help\n```\n").failures.size() == 1);
  CHECK(run_document("```sh\ntagsmith conjure\n```\n").failures.size() == 1);
}

TEST_CASE("an output that the program no longer prints is found") {
  const std::string command = "```sh\ntagsmith validate surveys/corridor/survey.yaml\n```\n";
  CHECK(run_document(command + "```text\n1 file: 0 errors, 0 warnings\n```\n").failures.empty());
  CHECK(run_document(command + "```text\n...\n```\n").failures.empty());
  CHECK(run_document(command + "```text\n1 file: 7 errors\n```\n").failures.size() == 1);
}

TEST_CASE("only tagsmith commands of sh blocks run, and files are written first") {
  const DocumentRun run = run_document(
      "```sh\n./dev test\nexit 3\n```\n"
      "```text\n```\n"
      "```yaml file=a/b.yaml\nsurvey: [\n```\n"
      "    tagsmith conjure\n"
      "```sh exit=1\ntagsmith \\\n  validate a/b.yaml\n```\n");
  CHECK(run.commands == 1);
  CHECK_MESSAGE(run.failures.empty(), joined(run.failures));
}

TEST_CASE("links to files are found") {
  const std::vector<std::string> expected{"docs/a.md", "b.png", "c.md"};
  CHECK(linked_files("[a](docs/a.md) ![b](b.png) [c](c.md#part) [d](https://e.org/f) [g](#h)") ==
        expected);
}

}  // namespace tagsmith::detail::test
