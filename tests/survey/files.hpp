// SPDX-License-Identifier: Apache-2.0
// Files for the tests of the readers: right ones to break, and how to look for a finding.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tagsmith/base/diagnostic.hpp"
#include "tagsmith/survey/survey.hpp"

namespace tagsmith::detail::test {

// A right survey of 20 lines whose template lies among the tool's own.
std::string right_survey();
std::string right_rig();
std::string right_template();

// `text` with the first `from` replaced; throws when it is not there, so that no case tests
// nothing.
std::string replaced(std::string text, const std::string& from, const std::string& to);

// Writes the file and returns its path.
std::filesystem::path write_text(const std::filesystem::path& path, const std::string& text);

// The survey of a right file; throws its findings when it is wrong.
Survey survey_of(const std::string& text);

// How many findings have this rule and line; line -1 = any.
int count_findings(const std::vector<Diagnostic>& diagnostics, const std::string& code,
                   int line = -1);

// One way to break a right file, and what must be said about it.
struct Breakage {
  std::string name;
  const char* from;
  const char* to;
  const char* code;
  int line;
};

}  // namespace tagsmith::detail::test
