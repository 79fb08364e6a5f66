// SPDX-License-Identifier: Apache-2.0
// The front door: the list of commands.
#include <CLI/CLI.hpp>

#include <vector>

#include "tagsmith/cli/command.hpp"

int main(int argc, char** argv) {
  CLI::App app{"tagsmith: position tags for mine tunnels, from the survey to the vehicle's position"};
  app.require_subcommand(1);
  const std::vector<tagsmith::Command> commands{};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? tagsmith::kExitOk : tagsmith::kExitFailure;
  }
  for (const tagsmith::Command& command : commands) {
    if (command.app->parsed()) return command.run();
  }
  return tagsmith::kExitFailure;
}
