// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/command.hpp"

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/console.hpp"

namespace tagsmith::detail {

std::vector<std::string> CommandOption::all_names() const { return split(names, ','); }

int report_failure(const std::string& command, const Error& error) {
  // Further lines are indented: a file's name may hold a line feed, and must not begin a line.
  const std::string message = fmt::format("{}", fmt::join(split(error.message, '\n'), "\n  "));
  to_stderr("tagsmith {}: {}\n", command, Lines{message});
  return kExitFailure;
}

void print_assumptions(const std::string& command, const std::vector<std::string>& assumed) {
  for (const std::string& sentence : assumed) {
    to_stderr("tagsmith {}: {}\n", command, sentence);
  }
}

}  // namespace tagsmith::detail
