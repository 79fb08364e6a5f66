// SPDX-License-Identifier: Apache-2.0
// Runs programs in tests, the tagsmith executable first of all.
#pragma once

#include <filesystem>
#include <string>

namespace tagsmith::detail::test {

struct ProgramOutput {
  int exit_code = -1;
  std::string out;
  std::string err;
};

// Runs a shell command; the exit code is 128 + signal when it was killed.
ProgramOutput run_shell(const std::string& command);

// Runs the tagsmith executable under test with these arguments (shell words).
ProgramOutput run_tagsmith(const std::string& arguments);

// True when the program is on the PATH.
bool has_program(const std::string& name);

// A new empty folder, removed with everything in it at the end of its scope.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace tagsmith::detail::test
