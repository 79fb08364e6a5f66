// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/command.hpp"

#include <algorithm>
#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/console.hpp"

namespace tagsmith {

std::string unknown_command(const std::vector<Command>& commands,
                            const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments.front().starts_with('-')) return {};
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const Command& command : commands) names.push_back(command.app->get_name());
  const std::string& found = arguments.front();
  if (std::ranges::find(names, found) != names.end()) return {};
  const auto near = nearest_word(found, names);
  return "no command `" + found + "`" + (near ? ", did you mean `" + *near + "`?" : "");
}

int report_failure(const std::string& command, const Error& error) {
  // Further lines are indented: a file's name may hold a line feed, and must not begin a line.
  std::string message;
  for (const char c : error.message) message += c == '\n' ? std::string("\n  ") : std::string(1, c);
  to_stderr("tagsmith {}: {}\n", command, Lines{message});
  return kExitFailure;
}

void print_assumptions(const std::string& command, const std::vector<std::string>& assumed) {
  for (const std::string& sentence : assumed) {
    to_stderr("tagsmith {}: {}\n", command, sentence);
  }
}

}  // namespace tagsmith
