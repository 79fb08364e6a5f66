// SPDX-License-Identifier: Apache-2.0
#include "tests/support/program.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <sys/wait.h>

namespace tagsmith::detail::test {
namespace fs = std::filesystem;
namespace {

std::string contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

ProgramOutput run_shell(const std::string& command) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const fs::path err = folder.path() / "err";
  const std::string line =
      "( " + command + "\n) > '" + out.string() + "' 2> '" + err.string() + "' < /dev/null";
  const int status = std::system(line.c_str());
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, contents(out), contents(err)};
}

ProgramOutput run_tagsmith(const std::string& arguments) {
  const char* program = std::getenv("TAGSMITH_PROGRAM");
  if (program == nullptr) {
    throw std::runtime_error("TAGSMITH_PROGRAM must name the executable under test");
  }
  return run_shell("'" + std::string(program) + "' " + arguments);
}

bool has_program(const std::string& name) { return run_shell("command -v " + name).exit_code == 0; }

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "tagsmith-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace tagsmith::detail::test
