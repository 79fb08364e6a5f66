// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/base/file.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/contents.hpp"
#include "tests/support/program.hpp"

using namespace tagsmith::detail;
using namespace tagsmith::detail::test;
namespace fs = std::filesystem;

namespace {

std::string problem_of(const fs::path& path) {
  const auto bytes = read_file(path, 1000);
  return bytes ? "" : bytes.error().message;
}

}  // namespace

TEST_CASE("a missing file's message says what is there instead") {
  const TemporaryFolder folder;
  const std::string in = folder.path().string() + "/";
  std::ofstream(in + "survey.yaml") << "x";
  CHECK(problem_of(in + "survye.yaml") ==
        in + "survye.yaml: no such file, did you mean " + in + "survey.yaml?");
  CHECK(problem_of(in + "elsewhere") == in + "elsewhere: no such file");
  CHECK(problem_of(in + "deep/down/rig.yaml") ==
        in + "deep/down/rig.yaml: no such file, nor a folder " + in + "deep/down, nor a folder " +
            in + "deep");
}

TEST_CASE("a folder's message names the first four YAML files in it") {
  const TemporaryFolder folder;
  const std::string in = folder.path().string() + "/",
                    is = folder.path().string() + ": is a directory, expected a file";
  CHECK(problem_of(folder.path()) == is);
  std::ofstream(in + "notes.txt") << "x";
  CHECK(problem_of(folder.path()) == is);
  for (const char* name : {"d.yaml", "c.yml", "b.yaml", "a.yml"}) std::ofstream(in + name) << "x";
  const std::string four =
      "; in it there is " + in + "a.yml, " + in + "b.yaml, " + in + "c.yml, " + in + "d.yaml";
  CHECK(problem_of(folder.path()) == is + four);
  std::ofstream(in + "e.yaml") << "x";
  CHECK(problem_of(folder.path()) == is + four + ", ...");
}

TEST_CASE("a file of as many bytes as the limit is read, of one more not") {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "file";
  std::ofstream(file) << std::string(1000, 'x');
  CHECK(read_file(file, 1000) == std::string(1000, 'x'));
  CHECK_FALSE(read_file(file, 999));
}

TEST_CASE("a file is written whole, in new folders too, and leaves nothing beside it") {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "new" / "file";
  CHECK(write_file(file, "one"));
  CHECK(write_file(file, "two"));
  CHECK(contents(file) == "two");
  CHECK_FALSE(write_file(folder.path(), "x"));
  CHECK_FALSE(write_file(file / "below", "x"));
  CHECK_FALSE(write_file(folder.path() / std::string(256, 'n'), "x"));
  CHECK(write_file(folder.path() / std::string(255, 'n'), "x"));
  CHECK(std::distance(fs::recursive_directory_iterator(folder.path()), {}) == 3);
}

TEST_CASE("a link stays where it is written through, and one that leads to itself is told") {
  const TemporaryFolder folder;
  const fs::path link = folder.path() / "link", loop = folder.path() / "loop";
  fs::create_symlink("file", link);
  fs::create_symlink("loop", loop);
  CHECK(write_file(link, "one"));
  CHECK(fs::is_symlink(link));
  CHECK(contents(folder.path() / "file") == "one");
  CHECK_FALSE(write_file(loop, "one"));
  CHECK(fs::is_symlink(loop));
}

TEST_CASE("as many links are followed as Linux follows, forty") {
  const TemporaryFolder folder;
  fs::path last = "file";
  for (int i = 1; i <= 40; ++i) {
    const fs::path link = "link" + std::to_string(i);
    fs::create_symlink(last, folder.path() / link);
    last = link;
  }
  CHECK(write_file(folder.path() / last, "one"));
  CHECK(contents(folder.path() / "file") == "one");
  CHECK(fs::is_symlink(folder.path() / last));
}

TEST_CASE("pipes and devices are not read where a regular file is expected") {
  const auto device = read_regular_file("/dev/null", 100);
  REQUIRE_FALSE(device);
  CHECK(device.error().message == "/dev/null: is a device, expected a regular file");
}
