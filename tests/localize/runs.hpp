// SPDX-License-Identifier: Apache-2.0
// Running `localize` and reading what it wrote.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/contents.hpp"
#include "tests/support/json.hpp"

namespace tagsmith::detail::test {

// The command line on a shipped survey and its rig.
inline std::string on_survey(const std::string& name, const std::string& run) {
  const std::string folder = "surveys/" + name;
  return "localize " + folder + "/survey.yaml --rig " + folder + "/rig.yaml --run " + run;
}

// Writes the file and returns its path.
inline std::string file_with(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
  return path.string();
}

inline std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

}  // namespace tagsmith::detail::test
