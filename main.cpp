// SPDX-License-Identifier: Apache-2.0
// The front door: runs the command that was asked for.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "decoder/cli/commands.hpp"
#include "tagsmith/cli/command.hpp"
#include "tagsmith/cli/console.hpp"

namespace {

// Runs the command that was chosen. Results that never reached standard output are a failure.
int run(const tagsmith::Command& command) {
  const int exit_code = command.run();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  return tagsmith::report_failure(command.app->get_name(), {"standard output cannot be written"});
}

// What the parser answers instead of running a command: the help, the version, or what is wrong.
int answer(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() != 0) {
    tagsmith::to_stderr("{}\nRun with --help for more information.\n", error.what());
    return tagsmith::kExitFailure;
  }
  std::ostringstream help;
  app.exit(error, help, help);
  tagsmith::bytes_to_stdout(help.str());
  return tagsmith::kExitOk;
}

int run(int argc, char** argv) {
  CLI::App app{
      "tagsmith: position tags for mine tunnels, from the survey to the vehicle's position"};
  app.require_subcommand(1);
  app.set_version_flag("--version", "tagsmith " TAGSMITH_VERSION);
  const std::vector<tagsmith::Command> commands = tagsmith::add_commands(app);
  if (const auto problem =
          tagsmith::unknown_command(commands, {argv + std::min(argc, 1), argv + argc});
      !problem.empty()) {
    tagsmith::to_stderr("tagsmith: {}\nRun with --help for the list.\n", problem);
    return tagsmith::kExitFailure;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return answer(app, error);
  }
  for (const tagsmith::Command& command : commands) {
    if (command.app->parsed()) return run(command);
  }
  return tagsmith::kExitFailure;
}

}  // namespace

int main(int argc, char** argv) {
  tagsmith::mute_libraries();
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {  // what no library foresees, such as no memory left
    tagsmith::to_stderr("tagsmith: {}\n", error.what());
    return tagsmith::kExitFailure;
  }
}
