// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "tests/support/program.hpp"

namespace tagsmith::detail::test {

inline constexpr const char* kCorridor = "surveys/corridor/survey.yaml";

inline ProgramOutput print(const std::string& survey, const std::filesystem::path& folder,
                           const std::string& options = {}) {
  return run_tagsmith("print '" + survey + "' -o '" + folder.string() + "' " + options);
}

}  // namespace tagsmith::detail::test
