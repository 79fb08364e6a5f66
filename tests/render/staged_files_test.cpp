// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/staged_files.hpp"

#include <string>

#include <doctest/doctest.h>

#include "tagsmith/base/file.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
namespace fs = std::filesystem;

namespace {

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("published files appear, replacing older ones, and nothing else") {
  const TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "a/b";
  REQUIRE(write_file(folder / "one", "old"));
  REQUIRE(write_file(folder / "other", "kept"));
  {
    Result<StagedFiles> files = StagedFiles::begin(folder);
    REQUIRE(files);
    REQUIRE(files->add("one", "1"));
    REQUIRE(files->add("two", "2"));
    CHECK(read_file(folder / "one").value() == "old");
    CHECK_FALSE(fs::exists(folder / "two"));
    REQUIRE(files->publish());
  }
  CHECK(read_file(folder / "one").value() == "1");
  CHECK(read_file(folder / "two").value() == "2");
  CHECK(read_file(folder / "other").value() == "kept");
  CHECK(entries(folder) == 3);
}

TEST_CASE("names are as long as the system allows, and no longer") {
  const TemporaryFolder temporary;
  const std::string longest(255, 'n');
  for (const char* content : {"1", "2"}) {
    Result<StagedFiles> files = StagedFiles::begin(temporary.path());
    REQUIRE(files);
    REQUIRE(files->add(longest, content));
    const Result<void> longer = files->add(longest + "n", content);
    REQUIRE_FALSE(longer);
    CHECK(longer.error().message.ends_with("the name has 256 bytes, expected at most 255"));
    REQUIRE(files->publish());
  }
  CHECK(read_file(temporary.path() / longest).value() == "2");
  CHECK(entries(temporary.path()) == 1);
}

TEST_CASE("of folders on a detour none is left") {
  const TemporaryFolder temporary;
  {
    Result<StagedFiles> files = StagedFiles::begin(temporary.path() / "a/../b");
    REQUIRE(files);
    REQUIRE(files->add("one", "1"));
    REQUIRE(files->publish());
  }
  CHECK(read_file(temporary.path() / "b/one").value() == "1");
  CHECK(entries(temporary.path()) == 1);
}

TEST_CASE("files that are not published leave nothing, not even the folders made for them") {
  const TemporaryFolder temporary;
  {
    const Result<StagedFiles> files = StagedFiles::begin(temporary.path() / "a/b/c/");
    REQUIRE(files);
    REQUIRE(files->add("one", "1"));
    CHECK(fs::exists(temporary.path() / "a/b/c"));
  }
  CHECK(entries(temporary.path()) == 0);
}

TEST_CASE("when one file cannot take its place, the others give theirs back") {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  REQUIRE(write_file(folder / "a", "old"));
  REQUIRE(write_file(folder / "c/in the way", ""));
  {
    Result<StagedFiles> files = StagedFiles::begin(folder);
    REQUIRE(files);
    for (const char* name : {"a", "b", "c"}) REQUIRE(files->add(name, "new"));
    const Result<void> published = files->publish();
    REQUIRE_FALSE(published);
    CHECK(published.error().message.find("c: is a folder") != std::string::npos);
  }
  CHECK(read_file(folder / "a").value() == "old");
  CHECK_FALSE(fs::exists(folder / "b"));
  CHECK(entries(folder) == 2);
}

TEST_CASE("an interrupt leaves nothing, not even the folders, and ends the process by its signal") {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  REQUIRE(write_file(folder / "drive.yaml",
                     "survey: long\ntunnel: { width: 3, height: 3, centerline: { start: [0, 0, 0], "
                     "heading: 0, elements: [ { line: 2000 } ] } }\ntags: { template: tag-400x300, "
                     "height: 1, spacing: 0.6, first: 1, pairs: 1500 }\ncode: { check_digit: gs1, "
                     "resolution: [0.1, 0.01, 0.1], digits: [2, 7, 2], origin: [-5, 0, 0] }\n"));
  for (const auto& [name, code] : {std::pair{"INT", 130}, std::pair{"TERM", 143}}) {
    CAPTURE(name);
    const std::string out = (folder / "out/print").string();
    const ProgramOutput output = run_shell(
        "timeout --preserve-status -s " + std::string(name) + " 0.5 \"$TAGSMITH_PROGRAM\" print '" +
        (folder / "drive.yaml").string() + "' -o '" + out + "' --format pdf,svg");
    CHECK(output.exit_code == code);
    CHECK(entries(folder) == 1);
  }
}

TEST_CASE("an interrupt while the folders are made leaves none of them") {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  for (int k = 0; k < 30; ++k) {
    const double seconds = 0.015 + 0.001 * k;
    CAPTURE(seconds);
    run_shell("timeout -s INT " + std::to_string(seconds) +
              " \"$TAGSMITH_PROGRAM\" print surveys/corridor/survey.yaml -o '" +
              (folder / "out/print").string() + "'");
    CHECK((entries(folder) == 0 || fs::exists(folder / "out/print/manifest.json")));
    fs::remove_all(folder / "out");
  }
}

TEST_CASE("what a killed process left is removed, what a living one gathers is not") {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  REQUIRE(write_file(folder / ".tagsmith-kilLed/page.pdf", "half"));
  REQUIRE(write_file(folder / ".tagsmithless", "kept"));
  const Result<StagedFiles> living = StagedFiles::begin(folder);
  REQUIRE(living);
  CHECK_FALSE(fs::exists(folder / ".tagsmith-kilLed"));
  REQUIRE(living->add("one", "1"));
  CHECK(StagedFiles::begin(folder));
  CHECK(fs::exists(living->staged("one")));
  CHECK(fs::exists(folder / ".tagsmithless"));
}

TEST_CASE("a folder that cannot be made is an error that names it") {
  const TemporaryFolder temporary;
  REQUIRE(write_file(temporary.path() / "file", ""));
  for (const char* name : {"file", "file/folder"}) {
    const Result<StagedFiles> files = StagedFiles::begin(temporary.path() / name);
    REQUIRE_FALSE(files);
    CHECK(files.error().message ==
          (temporary.path() / "file").string() + ": is a file, expected a folder");
  }
  CHECK_FALSE(StagedFiles::begin("/proc/tagsmith"));
}
