// SPDX-License-Identifier: Apache-2.0
// Links, pipes and devices as outputs are written through, never replaced.
#include <filesystem>
#include <string>

#include <doctest/doctest.h>
#include <sys/stat.h>

#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/staged_files.hpp"
#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;
using namespace tagsmith::detail;
using namespace tagsmith::detail::test;

namespace {

const std::string kExport = "export surveys/corridor/survey.yaml --format csv -o ";

}  // namespace

TEST_CASE("a link stays a link, and what it leads to is replaced, or made where nothing is") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder.path() / "elsewhere/old", "old"));
  fs::create_symlink("elsewhere/old", folder.path() / "link");
  fs::create_symlink("link", folder.path() / "link-of-link");
  fs::create_symlink("elsewhere/new", folder.path() / "dangling");
  REQUIRE(write_file(folder.path() / "link-of-link", "1"));
  REQUIRE(write_file(folder.path() / "dangling", "2"));
  CHECK(fs::is_symlink(folder.path() / "link"));
  CHECK(fs::is_symlink(folder.path() / "link-of-link"));
  CHECK(fs::is_symlink(folder.path() / "dangling"));
  CHECK(contents(folder.path() / "elsewhere/old") == "1");
  CHECK(contents(folder.path() / "elsewhere/new") == "2");
  fs::create_symlink("itself", folder.path() / "itself");
  CHECK_FALSE(write_file(folder.path() / "itself", "3"));
}

TEST_CASE("a set of files keeps links and writes to streams, and undoes what it can") {
  const TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "out";
  REQUIRE(write_file(temporary.path() / "elsewhere/kept", "old"));
  fs::create_directory(folder);
  fs::create_symlink("../elsewhere/kept", folder / "a");
  fs::create_symlink("/dev/null", folder / "b");
  {
    Result<StagedFiles> files = StagedFiles::begin(folder);
    REQUIRE(files);
    REQUIRE(files->add("a", "1"));
    REQUIRE(files->add("b", "2"));
    REQUIRE(files->publish());
  }
  CHECK(fs::is_symlink(folder / "a"));
  CHECK(fs::read_symlink(folder / "b") == "/dev/null");
  CHECK(contents(temporary.path() / "elsewhere/kept") == "1");
  REQUIRE(write_file(folder / "c/in the way", ""));
  {
    Result<StagedFiles> files = StagedFiles::begin(folder);
    REQUIRE(files);
    REQUIRE(files->add("a", "3"));
    REQUIRE(files->add("c", "4"));
    CHECK_FALSE(files->publish());
  }
  CHECK(contents(temporary.path() / "elsewhere/kept") == "1");
  const auto count = [](const fs::path& path) {
    return std::distance(fs::directory_iterator(path), fs::directory_iterator());
  };
  CHECK(count(temporary.path() / "elsewhere") == 1);
  CHECK(count(folder) == 3);
}

TEST_CASE("a command writes through devices, pipes and standard output") {
  const TemporaryFolder folder;
  const std::string at = folder.path().string() + "/";
  const std::string csv = run_tagsmith(kExport + "-").out;
  REQUIRE(csv.size() > 100);

  fs::create_symlink("/dev/null", at + "null");
  CHECK(run_tagsmith(kExport + at + "null").exit_code == 0);
  CHECK(fs::is_symlink(at + "null"));
  CHECK(fs::is_character_file("/dev/null"));

  fs::create_symlink("/dev/full", at + "full");
  CHECK(run_tagsmith(kExport + at + "full").exit_code == 2);
  CHECK(fs::is_character_file("/dev/full"));

  REQUIRE(::mkfifo((at + "pipe").c_str(), 0600) == 0);
  run_shell("timeout 60 cat '" + at + "pipe' > '" + at +
            "got' & timeout 60 \"$TAGSMITH_PROGRAM\" " + kExport + at + "pipe; wait");
  CHECK(fs::is_fifo(at + "pipe"));
  CHECK(contents(at + "got") == csv);

  CHECK(run_tagsmith(kExport + "/dev/stdout").out == csv);
  run_shell("cd '" + at + "' && echo first > log");
  run_tagsmith(kExport + "/dev/stdout >> '" + at + "log'");
  CHECK(contents(at + "log") == "first\n" + csv);
}
